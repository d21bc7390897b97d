// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/grasping/obstacles.hpp"
#include "bin_picking_perception/robot/kinematics.hpp"

namespace bin_picking
{
/// Why a grasp is not offered. One name for each thing that a person would do about it.
enum class GraspRejection
{
  None,
  MatchingRateTooLow,
  UndeterminedTurn,  ///< the turn of the part about an axis is not known, and the caller does not accept that
  OtherGripper,      ///< a grasp for fingers and a suction cup, or the other way round
  OpeningTooSmall,   ///< the gripper cannot open as far as the grasp asks
  ClosingTooSmall,   ///< the gripper cannot close as far as the part is wide
  Avoided,           ///< an attempt there failed not long ago
  TiltTooLarge,
  BinWallCollision,   ///< with a wall or its rim
  BinFloorCollision,  ///< with the floor
  PartCollision,      ///< with another detected part
  SceneCollision,     ///< with something measured that is no detected part
  UnseenSpace,        ///< through space that the sensor cannot see into
  TargetCollision,    ///< the open fingers meet the part itself on the way in
  HeldPartCollision,  ///< on the way out the part meets the bin, or what lies on it
  OutOfReach,         ///< no inverse kinematics for a pose of the way
  JointLimit,
  Singular,
  Discontinuous  ///< the arm would have to change its configuration on the way
};

/// "none", "matching_rate_too_low", ... for logs and messages.
const char* toString(GraspRejection rejection);

/// The straight way of one frame: to the pre-grasp, in to the grasp, out to the retreat. Camera frame, one orientation.
struct GraspWay
{
  Pose pre_grasp = Pose::Identity();
  Pose grasp = Pose::Identity();
  Pose retreat = Pose::Identity();
};

/// A grasp of one detection.
struct Grasp
{
  std::string uid;  ///< given by who offers the grasp to others; empty here
  std::string part;
  std::string grasp_id;
  std::size_t detection_index = 0;  ///< into DetectionResult::detections
  int symmetry_variant = 0;         ///< index into the sampled symmetry; 0 = as written
  double tilted = 0;                ///< rad, about the closing axis against what part.yaml says, within its tolerance
  double spun = 0;                  ///< rad, about the approach, likewise
  /// Of the frame between the finger tips as they are when holding: Z = approach, Y = closing. While the fingers are
  /// open, a linkage may hold the tips at another height: what is commanded is `tool0`.
  GraspWay tip;
  GraspWay tool0;                        ///< of the robot's flange
  Pose T_tip_object = Pose::Identity();  ///< the part in the hand, for placing
  bool undetermined_turn = false;        ///< up to the turn that the detection leaves open
  double width = 0;                      ///< metres, when holding
  double opening = 0;                    ///< metres, on the way in
  int priority = 0;
  double tilt = 0;  ///< rad, between the approach and straight down into the bin (or the view direction)

  bool collision_checked = false;
  Clearance clearance;  ///< of the whole way: what decides, see Clearance
  bool reach_checked = false;
  std::vector<Joints>
      joints;  ///< at pre-grasp, grasp and retreat, one branch; empty unless reach_checked and reachable

  double quality = 0;  ///< [0, 1], the sort key
  GraspRejection rejection = GraspRejection::None;
  std::string reason;  ///< one sentence with the numbers; empty if not rejected
};

struct GraspSelection
{
  std::vector<Grasp> grasps;    ///< pickable, best first
  std::vector<Grasp> rejected;  ///< with reasons; see GraspPlanner for what is listed
};
}  // namespace bin_picking
