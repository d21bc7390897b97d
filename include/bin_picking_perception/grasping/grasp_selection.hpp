// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/detector.hpp"
#include "bin_picking_perception/grasping/gripper.hpp"
#include "bin_picking_perception/model/part.hpp"
#include "bin_picking_perception/robot/robot.hpp"
#include "bin_picking_perception/scene/bin.hpp"

namespace bin_picking
{
/// Limits on the grasps that are offered.
struct GraspParameters
{
  double max_tilt = 0.785398;       // between the approach and straight down into the bin (or the view direction)
  double min_matching_rate = 0.85;  // the paper: above 85 % the robot succeeds
  double bin_clearance = 0.003;
  int continuous_symmetry_steps = 12;
  int max_grasps = 20;
  // What makes one grasp better than another: shares of the quality, relative to their sum.
  double weight_score = 4;
  double weight_height = 2;
  double weight_priority = 2;
  double weight_tilt = 1;
  double weight_clearance = 1;

  void visit(ParameterVisitor& v);
};

enum class GraspRejection
{
  None,
  MatchingRateTooLow,
  UndeterminedTurn,  ///< the turn of the part about an axis is not known, and the caller does not accept that
  TiltTooLarge,
  OpeningTooSmall,  ///< the gripper cannot open as far as the grasp asks
  BinWallCollision,
  BinFloorCollision,
  OutOfReach,
  Singular,
  JointLimit,
  Avoided  ///< the last attempt on the part failed, see AvoidList
};

/// "none", "matching_rate_too_low", ... for logs and messages.
const char* toString(GraspRejection rejection);

/// A grasp of one detection. All poses are of the frame between the finger tips: Z = approach, Y = closing.
struct Grasp
{
  std::string uid;  ///< given by who offers the grasp to others; empty here
  std::string part;
  std::string grasp_id;
  std::size_t detection_index = 0;  ///< into DetectionResult::detections
  int symmetry_variant = 0;         ///< index into the sampled symmetry; 0 = as written
  Pose T_camera_pre_grasp = Pose::Identity();
  Pose T_camera_grasp = Pose::Identity();
  Pose T_camera_retreat = Pose::Identity();
  Pose T_camera_tool0_pre_grasp = Pose::Identity();  ///< the same motion of the robot's flange
  Pose T_camera_tool0_grasp = Pose::Identity();
  Pose T_camera_tool0_retreat = Pose::Identity();
  Pose T_tip_object = Pose::Identity();  ///< the part in the hand, for placing
  bool undetermined_turn = false;        ///< up to the turn that the detection leaves open
  double width = 0;                      ///< metres, when holding
  double opening = 0;                    ///< metres, on the way in
  int priority = 0;
  double tilt = 0;                 ///< rad
  double bin_clearance = 0;        ///< smallest distance to the bin on the way, metres; NaN without a bin
  bool collision_checked = false;  ///< against more than the bin
  bool reach_checked = false;
  std::vector<Joints> joints;  ///< at pre-grasp, grasp, retreat, one branch; empty: not checked or not reached
  double quality = 0;          ///< [0, 1], the sort key
  GraspRejection rejection = GraspRejection::None;
  std::string reason;  ///< one sentence with the numbers; empty if not rejected
};

struct GraspSelection
{
  std::vector<Grasp> grasps;    ///< pickable, best first
  std::vector<Grasp> rejected;  ///< with reasons
};

/// Expands the grasps of each detected part by its symmetry, checks and ranks them.
/// Order: quality (to 1e-6), then the better detection, then the order in the part's definition, then the symmetry
/// variant. A matching rate, an open turn or an opening that rules out a grasp rules out all its symmetric copies: it
/// is then listed once. \param parts definitions by name; a detection of a part without definition has no grasps \param
/// bin nullptr: no wall check, tilt is measured against the camera's view direction \param accept_undetermined_turn
/// also of parts whose turn about an axis is not known: they are checked at the pose that the detection states, one of
/// those that the part may have \throws ParameterError a bin is given and the gripper has no bodies
GraspSelection selectGrasps(const std::vector<Detection>& detections, const std::vector<PartDefinition>& parts,
                            const Gripper& gripper, const Bin* bin, const GraspParameters& parameters,
                            bool accept_undetermined_turn = false);
}  // namespace bin_picking
