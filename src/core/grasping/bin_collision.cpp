// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_collision.hpp"

#include <limits>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
BinObstacles::BinObstacles(const Bin& bin)
{
  const double t = bin.wall_thickness;
  const Eigen::Vector3d inner = bin.inner_size;
  const Eigen::Vector3d outer = inner + Eigen::Vector3d(2 * t, 2 * t, 0);
  const auto add = [&](const char* name, bool floor, const Eigen::Vector3d& center, const Eigen::Vector3d& size) {
    sides_.push_back({name, floor, transformed(makeBox(center, size), bin.T_camera_bin)});
  };
  // The walls stand on the floor and end at the rim; the floor reaches under them.
  const double x = 0.5 * (inner.x() + t);
  const double y = 0.5 * (inner.y() + t);
  const double z = 0.5 * inner.z();
  add("floor", true, {0, 0, -0.5 * t}, {outer.x(), outer.y(), t});
  add("wall at +x", false, {x, 0, z}, {t, outer.y(), inner.z()});
  add("wall at -x", false, {-x, 0, z}, {t, outer.y(), inner.z()});
  add("wall at +y", false, {0, y, z}, {outer.x(), t, inner.z()});
  add("wall at -y", false, {0, -y, z}, {outer.x(), t, inner.z()});
}

BinClearance BinObstacles::clearance(const Gripper& gripper, const std::vector<GripperMotion>& motions) const
{
  if (gripper.bodies.empty())
    throw ParameterError("The gripper \"" + gripper.name +
                         "\" has no bodies, so that its way into the bin cannot be "
                         "checked; describe its palm and fingers in the gripper file.");
  BinClearance closest{std::numeric_limits<double>::infinity(), false, {}, {}};
  for (const GripperMotion& motion : motions)
    for (std::size_t i = 0; i < gripper.bodies.size(); ++i)
    {
      const ConvexBody body =
          swept(transformed(gripper.bodyAt(i, motion.opening), motion.T_camera_tool0), motion.motion_camera);
      for (const Side& side : sides_)
      {
        const double distance = bin_picking::clearance(body, side.box);
        if (distance < closest.distance)
          closest = {distance, side.floor, gripper.bodies[i].name, side.name};
      }
    }
  return closest;
}
}  // namespace bin_picking
