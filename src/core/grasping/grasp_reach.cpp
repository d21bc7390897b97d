// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/grasp_reach.hpp"

namespace bin_picking
{
namespace
{
GraspRejection toRejection(Reach::Failure failure)
{
  switch (failure)
  {
    case Reach::Failure::None:
      return GraspRejection::None;
    case Reach::Failure::OutOfReach:
    case Reach::Failure::NoSolution:
      return GraspRejection::OutOfReach;
    case Reach::Failure::JointLimit:
      return GraspRejection::JointLimit;
    case Reach::Failure::Singular:
    case Reach::Failure::Discontinuous:  // joints jump where the arm passes a singularity
      return GraspRejection::Singular;
  }
  return GraspRejection::OutOfReach;
}
}  // namespace

void checkReach(Grasp& grasp, const Kinematics& arm, const Pose& T_base_camera, const ReachParameters& parameters)
{
  ReachRequest request;
  for (const Pose* pose : {&grasp.T_camera_tool0_pre_grasp, &grasp.T_camera_tool0_grasp, &grasp.T_camera_tool0_retreat})
    request.waypoints_base_tool0.push_back(T_base_camera * *pose);
  const Reach found = reach(arm, request, parameters);
  grasp.reach_checked = true;
  grasp.rejection = toRejection(found.failure);
  grasp.reason = found.reason;
  if (found.failure == Reach::Failure::None)
    grasp.joints = found.joints;
}
}  // namespace bin_picking
