// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "plan_grasps.hpp"

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking::picking
{
namespace
{
PlannedGrasp planned(const Grasp& grasp, const Gripper& gripper)
{
  // The attitude and the place of the flange are those at the moment of holding.
  const Pose T_tip_tool0 = gripper.T_tool0_tip(grasp.width).inverse();
  PlannedGrasp result;
  result.detection = grasp.detection_index;
  result.id = grasp.grasp_id;
  result.T_camera_tool0_pre_grasp = grasp.T_camera_pre_grasp * T_tip_tool0;
  result.T_camera_tool0_grasp = grasp.T_camera_grasp * T_tip_tool0;
  result.T_camera_tool0_retreat = grasp.T_camera_retreat * T_tip_tool0;
  result.opening = grasp.opening;
  result.width = grasp.width;
  result.tilt = grasp.tilt;
  result.clearance = grasp.bin_clearance;
  return result;
}
}  // namespace

GraspPlan planGrasps(const PlanSetup& setup, const DetectionResult& result, const Bin& bin)
{
  if (!setup.robot_file.empty())
    throw ParameterError("the reach of a robot is not checked by this program; leave --robot away");
  const GraspSelection selection =
      selectGrasps(result.detections, setup.parts, setup.gripper, &bin, setup.parameters, true);
  GraspPlan plan;
  plan.checked.bin = true;
  for (const Grasp& grasp : selection.grasps)
    plan.grasps.push_back(planned(grasp, setup.gripper));
  for (const Grasp& grasp : selection.rejected)
    plan.rejected.push_back({grasp.detection_index, toString(grasp.rejection)});
  return plan;
}
}  // namespace bin_picking::picking
