// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "candidate_checks.hpp"

#include <algorithm>
#include <limits>

#include "bin_picking_perception/common/figures.hpp"
#include "bin_picking_perception/robot/reach.hpp"

namespace bin_picking
{
namespace
{
bool reject(Grasp& grasp, GraspRejection rejection, const std::string& reason)
{
  grasp.rejection = rejection;
  grasp.reason = reason;
  return false;
}

GraspRejection rejectionFor(const Clearance& closest)
{
  if (closest.body == HELD_PART)
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

const char* parameterOf(ObstacleKind kind)
{
  switch (kind)
  {
    case ObstacleKind::BinFloor:
    case ObstacleKind::BinWall:
      return "bin_clearance";
    case ObstacleKind::Part:
      return "part_clearance";
    case ObstacleKind::Target:
      return "target_clearance";
    default:
      return "surface_clearance";
  }
}

/// "the palm would ..."; what is not free is compared with what its parameter allows.
std::string passage(const Clearance& closest)
{
  const std::string body = "the " + closest.body + " would ";
  if (closest.body == HELD_PART)  // how much more is not looked for
    return body + "get more than " + millimetres(-closest.required) + " deeper into the " + closest.obstacle +
           " than it is at rest; no more is allowed (max_drag).";
  if (closest.kind == ObstacleKind::Unknown)
    return body + "reach " + toldApart(closest.distance, 0, millimetres).figure + " farther into the " +
           closest.obstacle +
           " than is allowed (unseen_entry; shadow_entry behind the part itself, unknown_entry behind what was not "
           "recognised).";
  const auto [figure, limit] = toldApart(closest.distance, closest.required, millimetres);
  const std::string passes =
      closest.distance < 0 ? "reach " + figure + " into the " : "pass at " + figure + " from the ";
  const std::string allowed =
      closest.required < 0 ? "at most " + limit + " into it are allowed" : "at least " + limit + " are required";
  return body + passes + closest.obstacle + "; " + allowed + " (" + parameterOf(closest.kind) + ").";
}

/// Keeps the passage that leaves the least room beyond what is required.
bool passes(Grasp& grasp, const Clearance& closest, const char* phase)
{
  if (!(closest.margin() >= grasp.clearance.margin()))
    grasp.clearance = closest;
  if (closest.free())
    return true;
  return reject(grasp, rejectionFor(closest), std::string(phase) + " " + passage(closest));
}

/// To a way that begins within the bin the gripper has to come, straight down from over the rim: what it covers then is
/// what it would cover on the way up.
bool comesDown(Grasp& grasp, const ToolShape& open, const GraspSurroundings& s)
{
  double lowest = std::numeric_limits<double>::infinity();
  for (const ToolPiece& piece : open)
    for (const Eigen::Vector3d& corner : piece.shape.vertices)
      lowest = std::min(lowest, (grasp.tool0.pre_grasp * corner).dot(s.up_camera));
  if (lowest >= s.rim)
    return true;
  const ToolMotion up{grasp.tool0.pre_grasp, (s.rim - lowest) * s.up_camera, grasp.opening};
  return passes(grasp, s.obstacles->approach(open, up, grasp.detection_index), "On the way down to the pre-grasp");
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

const Clearance& WayOut::along(const Eigen::Vector3d& motion_camera)
{
  const auto known =
      std::find_if(known_.begin(), known_.end(), [&](const Known& k) { return k.motion_camera == motion_camera; });
  if (known != known_.end())
    return known->clearance;
  known_.push_back({motion_camera, obstacles_.pulledOut(motion_camera, target_)});
  return known_.back().clearance;
}

Refusal checkDetection(std::size_t index, const GraspSurroundings& s)
{
  const Detection& detection = s.scene.detection.detections[index];
  const double required = s.setup.parameters.min_matching_rate;
  if (!(detection.matching_rate >= required))
  {
    const auto [rate, least] = toldApart(detection.matching_rate, required, percent);
    return {GraspRejection::MatchingRateTooLow,
            "The matching rate of the part is " + rate + ", at least " + least + " is required (min_matching_rate)."};
  }
  if (detection.undetermined_turn && !s.request.accept_undetermined_turn)
    return {GraspRejection::UndeterminedTurn, "Of the part, " + describe(*detection.undetermined_turn) +
                                                  "; the caller does not accept that (accept_undetermined_turn)."};
  const std::string why = s.request.avoid ? s.request.avoid(index) : std::string();
  return {why.empty() ? GraspRejection::None : GraspRejection::Avoided, why};
}

Refusal steepness(double tilt, const GraspSurroundings& s)
{
  const auto [figure, limit] = toldApart(tilt, s.setup.parameters.max_tilt, degrees);
  const char* reference = s.scene.bin ? "straight down into the bin" : "the view direction of the camera";
  return {GraspRejection::TiltTooLarge, "The approach is tilted by " + figure + " against " + reference + ", at most " +
                                            limit + " are allowed (max_tilt)."};
}

bool checkGripper(Grasp& grasp, const PreparedGrasp& prepared, const Eigen::Vector3d& out_camera,
                  const GraspSurroundings& s)
{
  grasp.collision_checked = true;
  const Obstacles& obstacles = *s.obstacles;
  const std::size_t target = grasp.detection_index;
  const ToolMotion in{grasp.tool0.pre_grasp, Eigen::Vector3d::Zero(), grasp.opening};  // the shape has moved
  const ToolMotion out{grasp.tool0.grasp, out_camera, grasp.width};
  return passes(grasp, obstacles.approach(prepared.way_in, in, target), "On the way in") &&
         passes(grasp, obstacles.closing(prepared.closing, grasp.tool0.grasp, target), "While closing") &&
         passes(grasp, obstacles.leaving(prepared.closed, out, target), "On the way out") &&
         comesDown(grasp, prepared.open, s);
}

bool checkHeldPart(Grasp& grasp, const Clearance& on_the_way_out)
{
  grasp.collision_checked = true;
  return passes(grasp, on_the_way_out, "On the way out");
}

bool checkReach(Grasp& grasp, const GraspSurroundings& s)
{
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
