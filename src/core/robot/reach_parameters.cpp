// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <cmath>

#include "bin_picking_perception/robot/reach.hpp"

namespace bin_picking
{
void ReachParameters::visit(ParameterVisitor& v)
{
  v.field(
      {"min_wrist_angle", "rad",
       "smallest angle of wrist_2 from 0 or half a turn, where the wrist loses a direction; larger gives up grasps, "
       "smaller lets wrist_1 and wrist_3 race on the way",
       0, M_PI_2},
      min_wrist_angle);
  v.field({"min_elbow_angle", "rad",
           "smallest angle of the elbow from stretched or folded; larger gives up grasps at the edge of the reach", 0,
           M_PI_2},
          min_elbow_angle);
  v.field(
      {"min_shoulder_distance", "m",
       "smallest distance of the wrist from the plane of the shoulder's axes; larger gives up grasps above the base, "
       "smaller lets shoulder_pan race on the way",
       0, 1},
      min_shoulder_distance);
  v.field({"path_step", "m", "distance of the poses that are tried on the straight way; smaller takes longer", 0.0005,
           0.05},
          path_step);
  v.field(
      {"max_joint_step", "rad", "largest motion of a joint between two such poses; more is taken for a jump", 0.01, 1},
      max_joint_step);
}

const char* toString(Reach::Failure failure)
{
  switch (failure)
  {
    case Reach::Failure::None:
      return "none";
    case Reach::Failure::OutOfReach:
      return "out_of_reach";
    case Reach::Failure::NoSolution:
      return "no_solution";
    case Reach::Failure::JointLimit:
      return "joint_limit";
    case Reach::Failure::Singular:
      return "singular";
    case Reach::Failure::Discontinuous:
      return "discontinuous";
  }
  return "unknown";
}
}  // namespace bin_picking
