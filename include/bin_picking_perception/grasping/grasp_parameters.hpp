// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/grasping/obstacles.hpp"
#include "bin_picking_perception/robot/reach.hpp"

namespace bin_picking
{
/// Limits on the grasps that are offered.
struct GraspParameters
{
  double max_tilt = 1.047198;
  double min_matching_rate = 0.85;  // the paper: above 85 % the robot succeeds
  int continuous_symmetry_steps = 12;
  int max_grasps = 20;
  int enough_grasps = 8;
  // What makes one grasp better than another: shares of the quality, relative to their sum.
  double weight_score = 4;
  double weight_height = 2;
  double weight_priority = 2;
  double weight_uncovered = 2;
  double weight_tilt = 1;
  double weight_clearance = 1;
  ObstacleParameters obstacles;
  ReachParameters reach;

  void visit(ParameterVisitor& v);
};
}  // namespace bin_picking
