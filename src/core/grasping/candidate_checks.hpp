// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <limits>
#include <vector>

#include "bin_picking_perception/grasping/grasp_planner.hpp"
#include "prepared_part.hpp"

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
  /// Out of the bin; without a bin towards the camera.
  Eigen::Vector3d up_camera = -Eigen::Vector3d::UnitZ();
  double rim = -std::numeric_limits<double>::infinity();  ///< of the bin, along up_camera, metres
};

/// How a part comes out of its surroundings, by the way it is lifted, which is the same for most of its grasps.
class WayOut
{
public:
  WayOut(const Obstacles& obstacles, std::size_t target) : obstacles_(obstacles), target_(target) {}

  /// The reference holds until the next call.
  const Clearance& along(const Eigen::Vector3d& motion_camera);

private:
  struct Known
  {
    Eigen::Vector3d motion_camera;
    Clearance clearance;
  };
  const Obstacles& obstacles_;
  std::size_t target_;
  std::vector<Known> known_;
};

/// What holds for all grasps of a detection: its matching rate, an open turn, the avoid list.
Refusal checkDetection(std::size_t index, const GraspSurroundings& s);

/// Of an approach that is tilted by more than is allowed.
Refusal steepness(double tilt, const GraspSurroundings& s);

// Each returns whether the grasp passed; if not, the rejection and its reason are filled in.

/// The gripper on the whole way: open in, closing, out, and straight down from over the bin's rim to where the way
/// begins. Fills in the closest passage.
/// \param out_camera how the grasp is lifted, metres
bool checkGripper(Grasp& grasp, const PreparedGrasp& prepared, const Eigen::Vector3d& out_camera,
                  const GraspSurroundings& s);
/// The part in the hand.
bool checkHeldPart(Grasp& grasp, const Clearance& on_the_way_out);
/// One configuration of the arm through the whole way. Fills in its joints. Needs the kinematics.
bool checkReach(Grasp& grasp, const GraspSurroundings& s);
}  // namespace bin_picking
