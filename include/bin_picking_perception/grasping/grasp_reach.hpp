// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "bin_picking_perception/grasping/grasp_selection.hpp"
#include "bin_picking_perception/robot/reach.hpp"

namespace bin_picking
{
/// Whether the arm gets to a grasp: its flange along the straight lines from the pre-grasp over the grasp to the
/// retreat. Sets `reach_checked`, and either `joints` or `rejection` and `reason`. \param T_base_camera camera in the
/// frame `base` of the robot's controller (see Robot, not base_link) \pre the grasp's poses of tool0 are finite \throws
/// ParameterError T_base_camera is not rigid
void checkReach(Grasp& grasp, const Kinematics& arm, const Pose& T_base_camera, const ReachParameters& parameters);
}  // namespace bin_picking
