// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/grasping/gripper.hpp"
#include "bin_picking_perception/scene/bin.hpp"

namespace bin_picking
{
/// Where and how closely the gripper passes a solid of the bin.
struct BinClearance
{
  double distance;           ///< signed, metres; < 0: collision
  bool floor = false;        ///< true: the floor, false: a wall
  std::string gripper_body;  ///< the part of the gripper that comes nearest
  std::string bin_side;      ///< "floor", "wall at +x", ...
};

/// A straight motion of the flange with a fixed finger distance.
struct GripperMotion
{
  Pose T_camera_tool0 = Pose::Identity();                   ///< at its start
  Eigen::Vector3d motion_camera = Eigen::Vector3d::Zero();  ///< metres
  double opening = 0;                                       ///< metres
};

/// The bin as five solid boxes, in the camera frame.
class BinObstacles
{
public:
  explicit BinObstacles(const Bin& bin);

  /// The closest passage of the gripper over all motions.
  /// \throws ParameterError the gripper has no bodies
  BinClearance clearance(const Gripper& gripper, const std::vector<GripperMotion>& motions) const;

  struct Side
  {
    std::string name;
    bool floor;
    ConvexBody box;  ///< camera frame
  };
  const std::vector<Side>& sides() const { return sides_; }

private:
  std::vector<Side> sides_;
};
}  // namespace bin_picking
