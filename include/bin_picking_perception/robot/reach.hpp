// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/robot/kinematics.hpp"

namespace bin_picking
{
/// How far the arm must stay from what it does badly.
struct ReachParameters
{
  double min_wrist_angle = 0.17;
  double min_elbow_angle = 0.17;
  double min_shoulder_distance = 0.10;
  double path_step = 0.005;
  double max_joint_step = 0.25;

  void visit(ParameterVisitor& v);
};

/// Poses that the flange passes on straight lines, in the frame `base` of the controller (see Robot): pre-grasp, grasp,
/// retreat. Between two of them the orientation turns evenly, if it differs.
struct ReachRequest
{
  std::vector<Pose> waypoints_base_tool0;
};

struct Reach
{
  enum class Failure
  {
    None,
    OutOfReach,    ///< the wrist would be farther from the shoulder than the arm is long
    NoSolution,    ///< the wrist would be too near to the shoulder or its axis
    JointLimit,    ///< a joint would have to turn beyond its limits
    Singular,      ///< closer to a singularity than the parameters allow
    Discontinuous  ///< a joint would have to jump between neighbouring poses
  };
  Failure failure = Failure::None;
  std::size_t waypoint = 0;    ///< that fails, or towards which the way fails
  std::string reason;          ///< one sentence with the numbers; empty if there is no failure
  std::vector<Joints> joints;  ///< one per waypoint, one branch, continuous between them; empty on failure
};

/// Whether the arm can follow the straight lines in one branch, and its joints.
///
/// Poses are tried every path_step along the lines; in between no joint moves more than max_joint_step, so that a
/// motion command between the waypoints finds the same way. Of the branches that pass, the one whose first waypoint is
/// nearest to the home pose (sum of squares of the joint differences, within the joints' limits) is taken, the lower
/// branch where they are equal:
/// the same request always has the same answer. Of a failure, the branch that comes farthest is reported. Collisions of
/// the arm itself are not looked at.
/// \throws ParameterError a parameter out of its range; no waypoints, or one that is not rigid or not finite
Reach reach(const Kinematics& kinematics, const ReachRequest& request, const ReachParameters& parameters = {});

/// "none", "out_of_reach", ... for logs and messages.
const char* toString(Reach::Failure failure);
}  // namespace bin_picking
