// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bin_picking_perception/detector.hpp"
#include "bin_picking_perception/grasping/grasp_planner.hpp"
#include "bin_picking_perception/grasping/gripper.hpp"

namespace bin_picking::picking
{
struct PlannedGrasp
{
  std::size_t detection = 0;  ///< into the detections that were given
  std::string id;             ///< of the grasp in part.yaml
  Pose T_camera_tool0_pre_grasp = Pose::Identity();
  Pose T_camera_tool0_grasp = Pose::Identity();
  Pose T_camera_tool0_retreat = Pose::Identity();
  double opening = 0;
  double width = 0;
  double tilt = 0;
  double clearance = 0;      ///< as the answer states it, metres; infinite: nothing is near
  bool vouched_for = false;  ///< the whole way was checked: a collision is one that the answer called free
};

struct RejectedGrasp
{
  std::size_t detection = 0;
  std::string cause;  ///< key
};

struct GraspPlan
{
  std::vector<PlannedGrasp> grasps;  ///< allowed, best first
  std::vector<RejectedGrasp> rejected;
};

/// The grasps of one cloud: parts with an open turn too, since a part that is out is out.
/// \param T_base_camera of the robot's base; needed where the planner has a robot
/// \param avoid see GraspPlanner::Request
GraspPlan planGrasps(const GraspPlanner& planner, const Detector& detector, const DetectionResult& result,
                     const Bin& bin, const Pose& T_base_camera, const std::function<std::string(std::size_t)>& avoid);
}  // namespace bin_picking::picking
