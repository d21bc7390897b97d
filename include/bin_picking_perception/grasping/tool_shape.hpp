// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/grasping/convex_body.hpp"
#include "bin_picking_perception/grasping/gripper.hpp"

namespace bin_picking
{
/// A convex piece of what a gripper covers, tool0 frame.
struct ToolPiece
{
  std::string body;       ///< name of the gripper's body
  bool may_touch_target;  ///< it closes on it, or is the lip that is pressed on it
  ConvexBody shape;
};

/// First the bodies that touch the part: they are in front, and the most likely to meet something.
using ToolShape = std::vector<ToolPiece>;

/// The bodies at an opening. Of a suction gripper those that touch the part may do so on the whole way. \throws
/// ParameterError no bodies, or an opening that the gripper does not have
ToolShape shapeAt(const Gripper& gripper, double opening);

/// What the moving bodies cover from one opening to another. Between the rows of its table a body moves straight; where
/// it also turns, the hull of both ends misses less than 0.1 mm of it for rows 5 degrees apart on 80 mm.
/// \throws ParameterError as above
ToolShape closingShape(const Gripper& gripper, double from, double to);

/// What the pieces cover while they all move straight by a motion, tool0 frame, metres.
ToolShape movedBy(const ToolShape& tool, const Eigen::Vector3d& motion);
}  // namespace bin_picking
