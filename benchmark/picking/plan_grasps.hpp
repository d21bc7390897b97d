// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/detector.hpp"
#include "bin_picking_perception/grasping/grasp_selection.hpp"
#include "bin_picking_perception/grasping/gripper.hpp"

namespace bin_picking::picking
{
/// What the answer vouches for: a collision with it is one that the answer called free.
struct Checked
{
  bool bin = false;        ///< the gripper against the bin
  bool parts = false;      ///< the gripper against all that lies around
  bool closing = false;    ///< the fingers on their way inwards
  bool held_part = false;  ///< the part in the hand on the way out
};

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
  double clearance = 0;  ///< to what the answer has checked, metres
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
  Checked checked;
};

/// What stays the same from cloud to cloud.
struct PlanSetup
{
  std::vector<PartDefinition> parts;
  Gripper gripper;
  std::string robot_file;  ///< empty: reach does not matter
  Pose T_base_camera = Pose::Identity();
  GraspParameters parameters;
};

/// The one place that knows how grasps are planned.
GraspPlan planGrasps(const PlanSetup& setup, const DetectionResult& result, const Bin& bin);
}  // namespace bin_picking::picking
