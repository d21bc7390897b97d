// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstddef>
#include <vector>

#include "body_sweep.hpp"

namespace bin_picking
{
struct GripperSweep
{
  std::size_t body;       ///< index into the gripper's bodies
  bool may_touch_target;  ///< it closes on it
  BodySweep sweep;
};

/// What the bodies cover on a straight way, camera frame; first those that touch the part, which are in front.
/// \throws ParameterError no bodies, or an opening that the gripper does not have
std::vector<GripperSweep> sweepsOf(const Gripper& gripper, const ToolMotion& motion);

/// What the moving bodies cover from one opening to another. Between the rows of its table a body moves straight; where
/// it also turns, the hull of both ends misses less than 0.1 mm of it for rows 5 degrees apart on 80 mm.
std::vector<GripperSweep> closingSweepsOf(const Gripper& gripper, const Pose& T_camera_tool0, double from, double to);
}  // namespace bin_picking
