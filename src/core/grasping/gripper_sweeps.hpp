// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstddef>
#include <functional>

#include "body_sweep.hpp"

namespace bin_picking
{
struct GripperSweep
{
  std::size_t body;       ///< index into the gripper's bodies
  bool may_touch_target;  ///< it closes on it
  BodySweep sweep;
};

/// Looks at a sweep. \return whether to go on with the next
using SweepVisitor = std::function<bool(const GripperSweep&)>;

/// What the bodies cover on a straight way, camera frame; first those that touch the part, which are in front. Made one
/// by one, since most ways end at the first.
/// \throws ParameterError no bodies, or an opening that the gripper does not have
void visitSweeps(const Gripper& gripper, const ToolMotion& motion, const SweepVisitor& visit);

/// What the moving bodies cover from one opening to another. Between the rows of its table a body moves straight; where
/// it also turns, the hull of both ends misses less than 0.1 mm of it for rows 5 degrees apart on 80 mm.
void visitClosingSweeps(const Gripper& gripper, const Pose& T_camera_tool0, double from, double to,
                        const SweepVisitor& visit);
}  // namespace bin_picking
