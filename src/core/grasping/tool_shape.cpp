// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <limits>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/grasping/tool_shape.hpp"

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

/// Whether each face looks along X or across it, as those of a box do; bodies turn about X.
bool isPrismAlongX(const ConvexBody& body)
{
  return std::all_of(body.planes.begin(), body.planes.end(), [](const Eigen::Vector4d& plane) {
    return std::abs(plane.x()) < 1e-9 || std::abs(plane.x()) > 1 - 1e-9;
  });
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// The hull of points in a plane, counter-clockwise (Andrew's monotone chain).
std::vector<Eigen::Vector2d> outlineOf(std::vector<Eigen::Vector2d> points)
{
  std::sort(points.begin(), points.end(), [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  std::vector<Eigen::Vector2d> outline;
  for (int half = 0; half < 2; ++half)
  {
    const std::size_t kept = outline.size();
    for (const Eigen::Vector2d& p : points)
    {
      while (outline.size() >= kept + 2 &&
             cross(outline.back() - outline[outline.size() - 2], p - outline.back()) <= 1e-15)
        outline.pop_back();
      outline.push_back(p);
    }
    outline.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return outline;
}

/// The hull of two prisms along X of the same length, by their outlines: makeHull would take far longer.
ConvexBody prismAround(const ConvexBody& a, const ConvexBody& b)
{
  std::vector<Eigen::Vector2d> points;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const ConvexBody* body : {&a, &b})
    for (const Eigen::Vector3d& v : body->vertices)
    {
      points.emplace_back(v.y(), v.z());
      low = std::min(low, v.x());
      high = std::max(high, v.x());
    }
  const std::vector<Eigen::Vector2d> outline = outlineOf(points);
  ConvexBody prism;
  prism.planes = {{1, 0, 0, -high}, {-1, 0, 0, low}};
  prism.edges = {Eigen::Vector3d::UnitX()};
  for (std::size_t i = 0; i < outline.size(); ++i)
  {
    const Eigen::Vector2d& p = outline[i];
    const Eigen::Vector2d along = (outline[(i + 1) % outline.size()] - p).normalized();
    prism.planes.emplace_back(0, along.y(), -along.x(), along.x() * p.y() - along.y() * p.x());
    prism.vertices.emplace_back(low, p.x(), p.y());
    prism.vertices.emplace_back(high, p.x(), p.y());
    const Eigen::Vector3d edge(0, along.x(), along.y());
    if (std::none_of(prism.edges.begin(), prism.edges.end(),
                     [&](const Eigen::Vector3d& other) { return other.cross(edge).norm() < 1e-9; }))
      prism.edges.push_back(edge);
  }
  return prism;
}

ConvexBody between(const Gripper& gripper, std::size_t body, double from, double to)
{
  const ConvexBody start = gripper.bodyAt(body, from);
  const Pose T_start = gripper.T_tool0_body(body, from);
  const Pose T_end = gripper.T_tool0_body(body, to);
  if (T_start.linear().isApprox(T_end.linear(), 1e-9))
    return swept(start, T_end.translation() - T_start.translation());
  if (isPrismAlongX(start))
    return prismAround(start, gripper.bodyAt(body, to));
  std::vector<Eigen::Vector3d> corners = start.vertices;
  for (const Eigen::Vector3d& v : gripper.bodyAt(body, to).vertices)
    corners.push_back(v);
  return makeHull(corners);
}
}  // namespace

ToolShape shapeAt(const Gripper& gripper, double opening)
{
  // The lip is pressed on the part, and is soft; fingers come down beside it.
  const bool may_touch = gripper.kind == Gripper::Kind::Suction;
  ToolShape pieces;
  for (const std::size_t i : orderOf(gripper))
    pieces.push_back({gripper.bodies[i].name, may_touch && gripper.bodies[i].touches_part, gripper.bodyAt(i, opening)});
  return pieces;
}

ToolShape closingShape(const Gripper& gripper, double from, double to)
{
  for (const double opening : {from, to})
    gripper.T_tool0_tip(opening);  // throws for one that the gripper does not have, also where no body moves
  ToolShape pieces;
  for (const std::size_t i : orderOf(gripper))
  {
    const GripperBody& body = gripper.bodies[i];
    if (body.placements.size() < 2)
      continue;  // it rests where the way in has already checked it
    const std::vector<double> stops = stopsOf(body, from, to);
    for (std::size_t k = 1; k < stops.size(); ++k)
      pieces.push_back({body.name, body.touches_part, between(gripper, i, stops[k - 1], stops[k])});
  }
  return pieces;
}

ToolShape movedBy(const ToolShape& tool, const Eigen::Vector3d& motion)
{
  ToolShape moved = tool;
  for (ToolPiece& piece : moved)
    piece.shape = swept(piece.shape, motion);
  return moved;
}
}  // namespace bin_picking
