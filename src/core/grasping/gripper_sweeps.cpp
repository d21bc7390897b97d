// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "gripper_sweeps.hpp"

#include <algorithm>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
/// Indices of the bodies, those in front first: they are the most likely to meet something.
std::vector<std::size_t> orderOf(const Gripper& gripper)
{
  if (gripper.bodies.empty())
    throw ParameterError("The gripper \"" + gripper.name +
                         "\" has no bodies, so that its way cannot be checked; describe its palm and fingers in the "
                         "gripper file.");
  std::vector<std::size_t> order(gripper.bodies.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    order[i] = i;
  std::stable_partition(order.begin(), order.end(), [&](std::size_t i) { return gripper.bodies[i].touches_part; });
  return order;
}

/// The openings between which a body moves straight.
std::vector<double> stopsOf(const GripperBody& body, double from, double to)
{
  std::vector<double> stops = {from};
  for (const GripperBody::Placement& row : body.placements)
    if (row.opening > std::min(from, to) && row.opening < std::max(from, to))
      stops.push_back(row.opening);
  stops.push_back(to);
  if (from > to)
    std::sort(stops.begin(), stops.end(), std::greater<double>());
  return stops;
}

ConvexBody between(const Gripper& gripper, std::size_t body, double from, double to)
{
  const ConvexBody start = gripper.bodyAt(body, from);
  const Pose T_start = gripper.T_tool0_body(body, from);
  const Pose T_end = gripper.T_tool0_body(body, to);
  if (T_start.linear().isApprox(T_end.linear(), 1e-9))
    return swept(start, T_end.translation() - T_start.translation());
  std::vector<Eigen::Vector3d> corners = start.vertices;
  for (const Eigen::Vector3d& v : gripper.bodyAt(body, to).vertices)
    corners.push_back(v);
  return makeHull(corners);
}
}  // namespace

std::vector<GripperSweep> sweepsOf(const Gripper& gripper, const ToolMotion& motion)
{
  std::vector<GripperSweep> sweeps;
  for (const std::size_t i : orderOf(gripper))
    sweeps.push_back({i, false,
                      BodySweep(swept(transformed(gripper.bodyAt(i, motion.opening), motion.T_camera_tool0),
                                      motion.motion_camera))});
  return sweeps;
}

std::vector<GripperSweep> closingSweepsOf(const Gripper& gripper, const Pose& T_camera_tool0, double from, double to)
{
  std::vector<GripperSweep> sweeps;
  for (const std::size_t i : orderOf(gripper))
  {
    const GripperBody& body = gripper.bodies[i];
    if (body.placements.size() < 2)
      continue;  // it rests where the way in has already checked it
    const std::vector<double> stops = stopsOf(body, from, to);
    for (std::size_t k = 1; k < stops.size(); ++k)
      sweeps.push_back(
          {i, body.touches_part, BodySweep(transformed(between(gripper, i, stops[k - 1], stops[k]), T_camera_tool0))});
  }
  return sweeps;
}
}  // namespace bin_picking
