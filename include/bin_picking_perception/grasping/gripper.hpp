// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bin_picking_perception/grasping/convex_body.hpp"

namespace bin_picking
{
// Frames: `tool0` is the robot's flange, Z out of it. `tip` lies between the fingers' pads: Z = approach, Y = closing
// direction; of a suction cup in the middle of the lip. Where the tip is in tool0 depends on the opening, since fingers
// on a linkage move on an arc.

/// A rigid piece of the gripper.
struct GripperBody
{
  std::string name;
  ConvexBody shape;  ///< tool0 frame, as it lies with offset and angle 0

  /// Where the piece is at one opening: turned about the X axis through the pivot, then moved.
  struct Placement
  {
    double opening = 0;                                ///< metres
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< metres
    double angle = 0;                                  ///< rad
  };
  std::vector<Placement> placements = {Placement()};  ///< by rising opening, linear between; one: it does not move
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();    ///< tool0 frame, metres
  bool touches_part = false;                          ///< finger pad or lip: shall touch the part that is taken
};

struct Gripper
{
  enum class Kind
  {
    Fingers,
    Suction
  };
  struct TipPlacement
  {
    double opening = 0;  ///< metres
    double height = 0;   ///< of the tip along Z of tool0, metres
  };

  std::string name;
  Kind kind = Kind::Fingers;
  double min_opening = 0;                        ///< metres
  double max_opening = 0;                        ///< metres; suction: both are 0
  std::vector<TipPlacement> tip_heights = {{}};  ///< by rising opening, linear between
  Eigen::Matrix3d R_tool0_tip = Eigen::Matrix3d::Identity();
  Eigen::Vector2d tip_xy = Eigen::Vector2d::Zero();  ///< of the tip in tool0, metres
  std::vector<GripperBody> bodies;

  /// \throws ParameterError an opening that the gripper does not have
  Pose T_tool0_tip(double opening) const;

  /// A piece as it lies at an opening, tool0 frame. \throws ParameterError an opening that the gripper does not have
  ConvexBody bodyAt(std::size_t body, double opening) const;

  /// How a piece lies at an opening: bodyAt() is its shape moved by this. \throws ParameterError as above
  Pose T_tool0_body(std::size_t body, double opening) const;
};

/// Reads a gripper file; docs/grippers.md describes it.
/// \throws FileError missing file, unknown key, a value that cannot be (with the line)
Gripper loadGripper(const std::string& path);
}  // namespace bin_picking
