// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <cmath>

#include "bin_picking_perception/grasping/grasp_parameters.hpp"

namespace bin_picking
{
void GraspParameters::visit(ParameterVisitor& v)
{
  v.field({"max_tilt", "rad",
           "largest angle between the approach and straight down into the bin (without a bin: the view direction); "
           "larger offers more grasps that the arm may not reach",
           0, M_PI},
          max_tilt);
  v.field(
      {"min_matching_rate", "", "smallest matching rate of a part that is grasped; smaller risks empty grips", 0, 1},
      min_matching_rate);
  v.field({"continuous_symmetry_steps", "", "copies of a grasp that are offered around an axis of revolution", 1, 360},
          continuous_symmetry_steps);
  v.field({"max_grasps", "", "most grasps that are returned", 1, 10000}, max_grasps);
  v.field({"enough_grasps", "",
           "as long as there are fewer, copies that a tolerance allows are tried for parts that have no other grasp; "
           "larger offers more and takes longer",
           0, 10000},
          enough_grasps);
  // At least one weight has to be positive: the quality is relative to their sum.
  v.field({"weight_score", "", "share of the detection's score in the quality", 0.001, 100}, weight_score);
  v.field({"weight_height", "", "share of the height in the pile: larger empties the bin from the top", 0, 100},
          weight_height);
  v.field({"weight_priority", "", "share of the priority written in the part's definition", 0, 100}, weight_priority);
  v.field({"weight_uncovered", "", "share of how much of the part is seen: larger leaves parts that lie under others",
           0, 100},
          weight_uncovered);
  v.field({"weight_tilt", "", "share of an upright approach", 0, 100}, weight_tilt);
  v.field({"weight_clearance", "", "share of the gripper's distance to bin and neighbours", 0, 100}, weight_clearance);
  v.group("obstacles", obstacles);
  v.group("reach", reach);
}
}  // namespace bin_picking
