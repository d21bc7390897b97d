// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/grasp.hpp"

namespace bin_picking
{
const char* toString(GraspRejection rejection)
{
  switch (rejection)
  {
    case GraspRejection::None:
      return "none";
    case GraspRejection::MatchingRateTooLow:
      return "matching_rate_too_low";
    case GraspRejection::UndeterminedTurn:
      return "undetermined_turn";
    case GraspRejection::OtherGripper:
      return "other_gripper";
    case GraspRejection::ClosingTooSmall:
      return "closing_too_small";
    case GraspRejection::OpeningTooSmall:
      return "opening_too_small";
    case GraspRejection::Avoided:
      return "avoided";
    case GraspRejection::TiltTooLarge:
      return "tilt_too_large";
    case GraspRejection::BinWallCollision:
      return "bin_wall_collision";
    case GraspRejection::BinFloorCollision:
      return "bin_floor_collision";
    case GraspRejection::PartCollision:
      return "part_collision";
    case GraspRejection::SceneCollision:
      return "scene_collision";
    case GraspRejection::UnseenSpace:
      return "unseen_space";
    case GraspRejection::TargetCollision:
      return "target_collision";
    case GraspRejection::HeldPartCollision:
      return "held_part_collision";
    case GraspRejection::OutOfReach:
      return "out_of_reach";
    case GraspRejection::JointLimit:
      return "joint_limit";
    case GraspRejection::Singular:
      return "singular";
    case GraspRejection::Discontinuous:
      return "discontinuous";
  }
  return "unknown";
}
}  // namespace bin_picking
