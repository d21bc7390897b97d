// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "bin_picking_perception/grasping/grasp_planner.hpp"

namespace bin_picking
{
/// What all grasps of one cloud are held against.
struct GraspSurroundings
{
  const GraspPlanner::Setup& setup;
  const GraspPlanner::Scene& scene;
  const GraspPlanner::Request& request;
  const Obstacles* obstacles = nullptr;    ///< nullptr: not checked
  const Kinematics* kinematics = nullptr;  ///< nullptr: not checked
  Eigen::Vector3d up_camera;               ///< out of the bin; without a bin towards the camera
};

// Each returns whether the grasp passed; if not, the rejection and its reason are filled in.

/// What holds for all copies of a grasp: the detection, the gripper's opening, the avoid list.
bool checkDetection(Grasp& grasp, const GraspSurroundings& s);
bool checkTilt(Grasp& grasp, const GraspSurroundings& s);
/// The whole way: open fingers in, closing, out with the part. Fills in the closest passage.
bool checkCollision(Grasp& grasp, const GraspSurroundings& s);
/// One configuration of the arm through the whole way. Fills in its joints.
bool checkReach(Grasp& grasp, const GraspSurroundings& s);
}  // namespace bin_picking
