// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "candidate_checks.hpp"

#include <cmath>
#include <iomanip>
#include <sstream>

#include "bin_picking_perception/robot/reach.hpp"

namespace bin_picking
{
namespace
{
std::string text(double value, int digits)
{
  std::ostringstream stream;
  stream << std::fixed << std::setprecision(digits) << value;
  return stream.str();
}

std::string millimetres(double value) { return text(1e3 * value, 1) + " mm"; }
std::string degrees(double value) { return text(value * 180 / M_PI, 1) + " deg"; }
std::string percent(double value) { return text(100 * value, 1) + " %"; }

bool reject(Grasp& grasp, GraspRejection rejection, const std::string& reason)
{
  grasp.rejection = rejection;
  grasp.reason = reason;
  return false;
}

/// A grasp without opening is one for a suction cup.
bool checkKind(Grasp& grasp, const Gripper& gripper)
{
  const bool by_suction = grasp.opening == 0;
  if (by_suction == (gripper.kind == Gripper::Kind::Suction))
    return true;
  return reject(grasp, GraspRejection::OtherGripper,
                by_suction ? "The grasp is one for a suction cup (its opening is 0), the gripper \"" + gripper.name +
                                 "\" has fingers."
                           : "The grasp is one for fingers (its opening is " + millimetres(grasp.opening) +
                                 "), the gripper \"" + gripper.name + "\" is a suction cup.");
}

bool checkOpening(Grasp& grasp, const Gripper& gripper)
{
  if (!(grasp.opening <= gripper.max_opening))
    return reject(grasp, GraspRejection::OpeningTooSmall,
                  "The grasp asks for an opening of " + millimetres(grasp.opening) + ", the gripper \"" + gripper.name +
                      "\" opens to " + millimetres(gripper.max_opening) + ".");
  if (!(grasp.width >= gripper.min_opening))
    return reject(grasp, GraspRejection::ClosingTooSmall,
                  "The part is " + millimetres(grasp.width) + " wide there, the gripper \"" + gripper.name +
                      "\" closes to " + millimetres(gripper.min_opening) + ".");
  return true;
}

GraspRejection rejectionFor(const Clearance& closest)
{
  if (closest.body == "held part")
    return GraspRejection::HeldPartCollision;
  switch (closest.kind)
  {
    case ObstacleKind::BinFloor:
      return GraspRejection::BinFloorCollision;
    case ObstacleKind::BinWall:
      return GraspRejection::BinWallCollision;
    case ObstacleKind::Part:
      return GraspRejection::PartCollision;
    case ObstacleKind::Target:
      return GraspRejection::TargetCollision;
    case ObstacleKind::Unknown:
      return GraspRejection::UnseenSpace;
    default:
      return GraspRejection::SceneCollision;
  }
}

/// Keeps the passage that leaves the least room beyond what is required.
bool passes(Grasp& grasp, const Clearance& closest, const char* phase)
{
  if (closest.distance - closest.required < grasp.clearance.distance - grasp.clearance.required)
    grasp.clearance = closest;
  if (closest.free())
    return true;
  const std::string passage = closest.distance < 0 ? " would reach " + millimetres(-closest.distance) + " into the "
                                                   : " would pass at " + millimetres(closest.distance) + " from the ";
  return reject(grasp, rejectionFor(closest),
                std::string(phase) + " the " + closest.body + passage + closest.obstacle + "; at least " +
                    millimetres(closest.required) + " are required.");
}

GraspRejection rejectionFor(Reach::Failure failure)
{
  switch (failure)
  {
    case Reach::Failure::JointLimit:
      return GraspRejection::JointLimit;
    case Reach::Failure::Singular:
      return GraspRejection::Singular;
    case Reach::Failure::Discontinuous:
      return GraspRejection::Discontinuous;
    default:
      return GraspRejection::OutOfReach;
  }
}
}  // namespace

bool checkDetection(Grasp& grasp, const GraspSurroundings& s)
{
  const Detection& detection = s.scene.detection.detections[grasp.detection_index];
  const double required = s.setup.parameters.min_matching_rate;
  if (!(detection.matching_rate >= required))
    return reject(grasp, GraspRejection::MatchingRateTooLow,
                  "The matching rate of the part is " + percent(detection.matching_rate) + ", at least " +
                      percent(required) + " is required (min_matching_rate).");
  if (detection.undetermined_turn && !s.request.accept_undetermined_turn)
    return reject(grasp, GraspRejection::UndeterminedTurn,
                  "Of the part, " + describe(*detection.undetermined_turn) +
                      "; the caller does not accept that (accept_undetermined_turn).");
  if (s.request.avoid)
  {
    const std::string why = s.request.avoid(grasp.detection_index);
    if (!why.empty())
      return reject(grasp, GraspRejection::Avoided, why);
  }
  return checkKind(grasp, s.setup.gripper) && checkOpening(grasp, s.setup.gripper);
}

bool checkTilt(Grasp& grasp, const GraspSurroundings& s)
{
  if (grasp.tilt <= s.setup.parameters.max_tilt)
    return true;
  const char* reference = s.scene.bin ? "straight down into the bin" : "the view direction of the camera";
  return reject(grasp, GraspRejection::TiltTooLarge,
                "The approach is tilted by " + degrees(grasp.tilt) + " against " + reference + ", at most " +
                    degrees(s.setup.parameters.max_tilt) + " are allowed (max_tilt).");
}

bool checkCollision(Grasp& grasp, const GraspSurroundings& s)
{
  if (!s.obstacles)
    return true;
  grasp.collision_checked = true;
  const Gripper& gripper = s.setup.gripper;
  const std::size_t target = grasp.detection_index;
  const Eigen::Vector3d at_grasp = grasp.tool0.grasp.translation();
  const ToolMotion in{grasp.tool0.pre_grasp, at_grasp - grasp.tool0.pre_grasp.translation(), grasp.opening};
  const ToolMotion out{grasp.tool0.grasp, grasp.tool0.retreat.translation() - at_grasp, grasp.width};
  return passes(grasp, s.obstacles->approach(gripper, in, target), "On the way in") &&
         passes(grasp, s.obstacles->closing(gripper, grasp.tool0.grasp, grasp.opening, grasp.width, target),
                "While closing") &&
         passes(grasp, s.obstacles->retreat(gripper, out, target), "On the way out");
}

bool checkReach(Grasp& grasp, const GraspSurroundings& s)
{
  if (!s.kinematics)
    return true;
  grasp.reach_checked = true;
  const Pose& T_base_camera = *s.scene.T_base_camera;
  const Reach found = reach(
      *s.kinematics,
      {{T_base_camera * grasp.tool0.pre_grasp, T_base_camera * grasp.tool0.grasp, T_base_camera * grasp.tool0.retreat}},
      s.setup.parameters.reach);
  if (found.failure != Reach::Failure::None)
    return reject(grasp, rejectionFor(found.failure), found.reason);
  grasp.joints = found.joints;
  return true;
}
}  // namespace bin_picking
