// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "plan_grasps.hpp"

namespace bin_picking::picking
{
namespace
{
PlannedGrasp planned(const Grasp& grasp)
{
  PlannedGrasp result;
  result.detection = grasp.detection_index;
  result.id = grasp.grasp_id;
  result.T_camera_tool0_pre_grasp = grasp.tool0.pre_grasp;
  result.T_camera_tool0_grasp = grasp.tool0.grasp;
  result.T_camera_tool0_retreat = grasp.tool0.retreat;
  result.opening = grasp.opening;
  result.width = grasp.width;
  result.tilt = grasp.tilt;
  result.clearance = grasp.clearance.distance;
  result.vouched_for = grasp.collision_checked;
  return result;
}
}  // namespace

GraspPlan planGrasps(const GraspPlanner& planner, const Detector& detector, const DetectionResult& result,
                     const Bin& bin, const Pose& T_base_camera, const std::function<std::string(std::size_t)>& avoid)
{
  GraspPlanner::Request request;
  request.accept_undetermined_turn = true;
  request.avoid = avoid;
  const GraspSelection selection = planner.plan({result, detector.models(), &bin, T_base_camera}, request);
  GraspPlan plan;
  for (const Grasp& grasp : selection.grasps)
    plan.grasps.push_back(planned(grasp));
  for (const Grasp& grasp : selection.rejected)
    plan.rejected.push_back({grasp.detection_index, toString(grasp.rejection)});
  return plan;
}
}  // namespace bin_picking::picking
