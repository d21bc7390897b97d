// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/grasp_selection.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <optional>
#include <sstream>
#include <utility>

#include "bin_collision.hpp"
#include "grasp_ranking.hpp"

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

/// What all grasps of one call are held against.
struct Surroundings
{
  const Gripper& gripper;
  const GraspParameters& parameters;
  const Bin* bin;
  bool accept_undetermined_turn;
  std::optional<BinObstacles> obstacles;
  Eigen::Vector3d up_camera;  ///< out of the bin; without a bin towards the camera
};

Surroundings surroundings(const Gripper& gripper, const Bin* bin, const GraspParameters& parameters,
                          bool accept_undetermined_turn)
{
  Surroundings s{gripper, parameters, bin, accept_undetermined_turn, std::nullopt, -Eigen::Vector3d::UnitZ()};
  if (bin)
  {
    s.obstacles.emplace(*bin);
    s.up_camera = bin->T_camera_bin.linear().col(2);
  }
  return s;
}

/// The flange's poses; not finite where the gripper does not have the width.
void setTool0(Grasp& grasp, const Gripper& gripper)
{
  Pose T_tip_tool0 = Pose::Identity();
  if (grasp.width >= gripper.min_opening && grasp.width <= gripper.max_opening)
    T_tip_tool0 = gripper.T_tool0_tip(grasp.width).inverse();
  else
    T_tip_tool0.translation().setConstant(std::numeric_limits<double>::quiet_NaN());
  grasp.T_camera_tool0_pre_grasp = grasp.T_camera_pre_grasp * T_tip_tool0;
  grasp.T_camera_tool0_grasp = grasp.T_camera_grasp * T_tip_tool0;
  grasp.T_camera_tool0_retreat = grasp.T_camera_retreat * T_tip_tool0;
}

Grasp makeGrasp(const Detection& detection, const GraspDefinition& definition, const Pose& T_object_variant,
                const Surroundings& s)
{
  const Pose& T_variant_tip = definition.T_object_tip;  // a symmetric copy is held just as the part itself
  Grasp grasp;
  grasp.part = detection.part;
  grasp.grasp_id = definition.id;
  grasp.T_camera_grasp = detection.T_camera_object * T_object_variant * T_variant_tip;
  grasp.T_tip_object = (T_object_variant * T_variant_tip).inverse();
  grasp.undetermined_turn = detection.undetermined_turn.has_value();
  const Eigen::Vector3d approach = grasp.T_camera_grasp.linear().col(2);
  const Eigen::Vector3d away = s.bin ? s.up_camera : Eigen::Vector3d(-approach);
  grasp.T_camera_pre_grasp = Eigen::Translation3d(-definition.approach * approach) * grasp.T_camera_grasp;
  grasp.T_camera_retreat = Eigen::Translation3d(definition.retreat * away) * grasp.T_camera_grasp;
  grasp.width = definition.width;
  grasp.opening = definition.opening;
  setTool0(grasp, s.gripper);
  grasp.priority = definition.priority;
  grasp.tilt = std::acos(std::clamp(-approach.dot(s.up_camera), -1.0, 1.0));
  grasp.bin_clearance = std::numeric_limits<double>::quiet_NaN();
  return grasp;
}

void reject(Grasp& grasp, GraspRejection rejection, const std::string& reason)
{
  grasp.rejection = rejection;
  grasp.reason = reason;
}

/// The checks that do not depend on the pose.
void checkDetectionAndGripper(Grasp& grasp, const Detection& detection, const Surroundings& s)
{
  const double required = s.parameters.min_matching_rate;
  if (!(detection.matching_rate >= required))
    reject(grasp, GraspRejection::MatchingRateTooLow,
           "The matching rate of the part is " + text(100 * detection.matching_rate, 1) + " %, at least " +
               text(100 * required, 1) + " % is required (min_matching_rate).");
  else if (detection.undetermined_turn && !s.accept_undetermined_turn)
    reject(grasp, GraspRejection::UndeterminedTurn,
           "Of the part, " + describe(*detection.undetermined_turn) +
               "; the caller does not accept that (accept_undetermined_turn).");
  else if (!(grasp.opening <= s.gripper.max_opening))
    reject(grasp, GraspRejection::OpeningTooSmall,
           "The grasp asks for an opening of " + millimetres(grasp.opening) + ", the gripper \"" + s.gripper.name +
               "\" opens to " + millimetres(s.gripper.max_opening) + ".");
}

void checkTilt(Grasp& grasp, const Surroundings& s)
{
  if (grasp.tilt <= s.parameters.max_tilt)
    return;
  const char* reference = s.bin ? "straight down into the bin" : "the view direction of the camera";
  reject(grasp, GraspRejection::TiltTooLarge,
         "The approach is tilted by " + degrees(grasp.tilt) + " against " + reference + ", at most " +
             degrees(s.parameters.max_tilt) + " are allowed (max_tilt).");
}

/// The way in with open fingers and the way out with the part held.
std::vector<GripperMotion> motionsOf(const Grasp& grasp, const Gripper& gripper)
{
  // The path is that of the flange, for which the grasp is where the tip is when it holds.
  const Pose T_tip_tool0 = gripper.T_tool0_tip(grasp.width).inverse();
  const Eigen::Vector3d at_grasp = grasp.T_camera_grasp.translation();
  return {{grasp.T_camera_pre_grasp * T_tip_tool0, at_grasp - grasp.T_camera_pre_grasp.translation(), grasp.opening},
          {grasp.T_camera_grasp * T_tip_tool0, grasp.T_camera_retreat.translation() - at_grasp, grasp.width}};
}

void checkBin(Grasp& grasp, const Surroundings& s)
{
  if (!s.obstacles)
    return;
  const BinClearance closest = s.obstacles->clearance(s.gripper, motionsOf(grasp, s.gripper));
  grasp.bin_clearance = closest.distance;
  if (closest.distance >= s.parameters.bin_clearance)
    return;
  const std::string passage = closest.distance < 0
                                  ? " would cut " + millimetres(-closest.distance) + " into the bin's "
                                  : " would pass at " + millimetres(closest.distance) + " from the bin's ";
  reject(grasp, closest.floor ? GraspRejection::BinFloorCollision : GraspRejection::BinWallCollision,
         "The gripper's " + closest.gripper_body + passage + closest.bin_side + ", at least " +
             millimetres(s.parameters.bin_clearance) + " are required (bin_clearance).");
}

/// Shares of the priority range of the part's grasps.
double priorityShare(const GraspDefinition& definition, const PartDefinition& part)
{
  const auto less = [](const GraspDefinition& a, const GraspDefinition& b) { return a.priority < b.priority; };
  const auto [lowest, highest] = std::minmax_element(part.grasps.begin(), part.grasps.end(), less);
  const double range = static_cast<double>(highest->priority) - lowest->priority;
  return range > 0 ? (static_cast<double>(definition.priority) - lowest->priority) / range : 1.0;
}

/// One detection with all that its grasps have in common.
struct Target
{
  const Detection& detection;
  std::size_t index;
  const PartDefinition& part;
  std::vector<Pose> variants;  ///< symmetric copies of the part, T_object_variant; the first is the identity
};

struct Outcome
{
  std::vector<GraspCandidate> accepted;
  std::vector<Grasp> rejected;
};

/// All copies of one grasp of one detection, checked.
void expandGrasp(const Target& target, const GraspDefinition& definition, const Surroundings& s, Outcome& outcome)
{
  const std::size_t num_variants = definition.symmetric ? target.variants.size() : 1;
  for (std::size_t v = 0; v < num_variants; ++v)
  {
    Grasp grasp = makeGrasp(target.detection, definition, target.variants[v], s);
    grasp.detection_index = target.index;
    grasp.symmetry_variant = static_cast<int>(v);
    checkDetectionAndGripper(grasp, target.detection, s);
    const bool all_copies_fail = grasp.rejection != GraspRejection::None;
    if (!all_copies_fail)
      checkTilt(grasp, s);
    if (grasp.rejection == GraspRejection::None)
      checkBin(grasp, s);

    if (grasp.rejection == GraspRejection::None)
    {
      const double height = grasp.T_camera_grasp.translation().dot(s.up_camera);
      outcome.accepted.push_back(
          {std::move(grasp), target.detection.score, priorityShare(definition, target.part), height});
    }
    else
      outcome.rejected.push_back(std::move(grasp));
    if (all_copies_fail)
      return;
  }
}
}  // namespace

GraspSelection selectGrasps(const std::vector<Detection>& detections, const std::vector<PartDefinition>& parts,
                            const Gripper& gripper, const Bin* bin, const GraspParameters& parameters,
                            bool accept_undetermined_turn)
{
  const Surroundings s = surroundings(gripper, bin, parameters, accept_undetermined_turn);
  Outcome outcome;
  for (std::size_t i = 0; i < detections.size(); ++i)
  {
    const auto part =
        std::find_if(parts.begin(), parts.end(), [&](const PartDefinition& p) { return p.name == detections[i].part; });
    if (part == parts.end())
      continue;
    const Target target{detections[i], i, *part, part->symmetry.sampled(parameters.continuous_symmetry_steps)};
    for (const GraspDefinition& definition : part->grasps)
      expandGrasp(target, definition, s, outcome);
  }

  GraspSelection selection;
  selection.rejected = std::move(outcome.rejected);
  selection.grasps = rankGrasps(std::move(outcome.accepted), parameters);
  if (selection.grasps.size() > static_cast<std::size_t>(parameters.max_grasps))
    selection.grasps.resize(static_cast<std::size_t>(parameters.max_grasps));
  return selection;
}
}  // namespace bin_picking
