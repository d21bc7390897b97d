// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "detection_grasps.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace bin_picking
{
namespace
{
// Of the ways that only a tolerance allows, a robot needs one; a few more leave it a choice.
constexpr std::size_t ENOUGH_TURNED = 4;

// Approaches steeper than allowed by this much are told by their direction alone; the rest is looked at exactly.
constexpr double ROUNDING = 1e-9;  // of the cosine

/// Along a direction, metres; no more than is so.
double lowestOf(const TrainedModel& model, const Pose& T_camera_object, const Eigen::Vector3d& up_camera)
{
  return (T_camera_object * model.center).dot(up_camera) - model.diameter / 2;
}

GraspWay moved(const GraspWay& way, const Pose& T_tip_other)
{
  return {way.pre_grasp * T_tip_other, way.grasp * T_tip_other, way.retreat * T_tip_other};
}
}  // namespace

DetectionGrasps::DetectionGrasps(std::size_t index, const PartDefinition& definition, const PreparedPart& part,
                                 const GraspSurroundings& s)
    : s_(s),
      index_(index),
      detection_(s.scene.detection.detections[index]),
      definition_(definition),
      part_(part),
      up_object_(detection_.T_camera_object.linear().transpose() * s.up_camera),
      over_rim_(s.rim - lowestOf(*s.scene.models[detection_.model_index], detection_.T_camera_object, s.up_camera)),
      least_cosine_(std::cos(s.setup.parameters.max_tilt) - ROUNDING),
      listed_(part.grasps.size()),
      refusal_(checkDetection(index, s))
{
  if (s.obstacles)
    way_out_.emplace(*s.obstacles, index);
}

void DetectionGrasps::tryAsWritten()
{
  rejected.reserve(part_.as_written);
  std::vector<std::optional<std::size_t>> least_steep(part_.grasps.size());
  for (std::size_t v = 0; v < part_.as_written; ++v)
  {
    const std::size_t g = part_.variants[v].grasp;
    std::optional<std::size_t>& least = least_steep[part_.grasps[g].as_written];
    if (const Refusal& refusal = refusalOf(g); refusal.rejection != GraspRejection::None)
      refuse(v, refusal);
    else if (!isTooSteep(v))
      asWritten(v);
    else if (!least || steeper(*least, v))
      least = v;
  }
  for (const std::optional<std::size_t>& v : least_steep)
    if (v)
      refuse(*v, steepness(tiltOf(*v), s_));
}

void DetectionGrasps::tryTurned()
{
  for (std::size_t v = part_.as_written; v < part_.variants.size() && allowed.size() < ENOUGH_TURNED; ++v)
    turned(v);
}

const Refusal& DetectionGrasps::refusalOf(std::size_t g) const
{
  return refusal_.rejection != GraspRejection::None ? refusal_ : part_.grasps[g].refusal;
}

/// What rules out more than one copy of a grasp: the first stands for all.
void DetectionGrasps::refuse(std::size_t v, const Refusal& refusal)
{
  const std::size_t g = part_.variants[v].grasp;
  if (isListed(g, refusal.rejection))
    return;
  Grasp grasp = makeGrasp(v);
  grasp.rejection = refusal.rejection;
  grasp.reason = refusal.reason;
  list(std::move(grasp), g);
}

void DetectionGrasps::asWritten(std::size_t v)
{
  const std::size_t g = part_.variants[v].grasp;
  if (isHeldDown(g))
    return;
  Grasp grasp = makeGrasp(v);
  if (passes(grasp, g))
    allow(std::move(grasp), g);
  else
    list(std::move(grasp), g);
}

void DetectionGrasps::turned(std::size_t v)
{
  const std::size_t g = part_.variants[v].grasp;
  if (part_.grasps[g].refusal.rejection != GraspRejection::None)
    return;
  if (isTooSteep(v))
  {
    if (!isListed(g, GraspRejection::TiltTooLarge))
      refuse(v, steepness(tiltOf(v), s_));
    return;
  }
  if (isHeldDown(g))
    return;
  Grasp grasp = makeGrasp(v);
  if (passes(grasp, g))
    allow(std::move(grasp), g);
  else if (!isListed(g, grasp.rejection))
    list(std::move(grasp), g);
}

bool DetectionGrasps::isListed(std::size_t g, GraspRejection rejection) const
{
  return listed_[part_.grasps[g].as_written].test(static_cast<std::size_t>(rejection));
}

bool DetectionGrasps::steeper(std::size_t v, std::size_t than) const
{
  return -part_.approaches_object[v].dot(up_object_) < -part_.approaches_object[than].dot(up_object_);
}

/// Radians, between the approach and straight down into the bin (or the view direction).
double DetectionGrasps::tiltOf(std::size_t v) const
{
  return std::acos(std::clamp(-part_.approaches_object[v].dot(up_object_), -1.0, 1.0));
}

/// By the direction alone where that tells, which is faster than an angle.
bool DetectionGrasps::isTooSteep(std::size_t v) const
{
  const double max_tilt = s_.setup.parameters.max_tilt;
  return -part_.approaches_object[v].dot(up_object_) < least_cosine_ || !(tiltOf(v) <= max_tilt);
}

/// Out of a bin, all copies of a grasp are lifted alike: what others hold down, none of them brings out.
bool DetectionGrasps::isHeldDown(std::size_t g) const
{
  return s_.scene.bin && isListed(g, GraspRejection::HeldPartCollision);
}

/// What tells most for the least comes first; without a bin each copy is lifted in a direction of its own.
bool DetectionGrasps::passes(Grasp& grasp, std::size_t g)
{
  const bool moves = s_.scene.bin ? comesOut(grasp, g) && isFree(grasp, g) : isFree(grasp, g) && comesOut(grasp, g);
  return moves && isReached(grasp);
}

bool DetectionGrasps::isFree(Grasp& grasp, std::size_t g) const
{
  return !s_.obstacles || checkGripper(grasp, part_.grasps[g], outOf(grasp, g), s_);
}
bool DetectionGrasps::comesOut(Grasp& grasp, std::size_t g)
{
  return !s_.obstacles || checkHeldPart(grasp, way_out_->along(outOf(grasp, g)));
}
bool DetectionGrasps::isReached(Grasp& grasp) const { return !s_.kinematics || checkReach(grasp, s_); }

/// Metres: as far as the robot retreats, and on to over the rim. By the definition, so that it is the same for all
/// grasps: a difference of poses would be so to rounding.
Eigen::Vector3d DetectionGrasps::outOf(const Grasp& grasp, std::size_t g) const
{
  return std::max(definition_.grasps[g].retreat, over_rim_) * awayFrom(grasp.tip.grasp);
}

Eigen::Vector3d DetectionGrasps::awayFrom(const Pose& T_camera_grasp) const
{
  return s_.scene.bin ? s_.up_camera : Eigen::Vector3d(-T_camera_grasp.linear().col(2));
}

Grasp DetectionGrasps::makeGrasp(std::size_t v) const
{
  const GraspVariant& variant = part_.variants[v];
  const GraspDefinition& definition = definition_.grasps[variant.grasp];
  Grasp grasp;
  grasp.part = detection_.part;
  grasp.grasp_id = definition.id;
  grasp.detection_index = index_;
  grasp.symmetry_variant = variant.symmetry_variant;
  grasp.tilted = variant.tilt;
  grasp.spun = variant.spin;
  grasp.tip = wayThrough(detection_.T_camera_object * variant.T_object_tip, definition);
  grasp.tool0 = moved(grasp.tip, part_.grasps[variant.grasp].T_tip_tool0);
  grasp.T_tip_object = variant.T_tip_object;
  grasp.undetermined_turn = detection_.undetermined_turn.has_value();
  grasp.width = definition.width;
  grasp.opening = definition.opening;
  grasp.priority = definition.priority;
  grasp.tilt = tiltOf(v);
  return grasp;
}

GraspWay DetectionGrasps::wayThrough(const Pose& T_camera_grasp, const GraspDefinition& definition) const
{
  const Eigen::Vector3d approach = T_camera_grasp.linear().col(2);
  GraspWay way;
  way.pre_grasp = Eigen::Translation3d(-definition.approach * approach) * T_camera_grasp;
  way.grasp = T_camera_grasp;
  way.retreat = Eigen::Translation3d(definition.retreat * awayFrom(T_camera_grasp)) * T_camera_grasp;
  return way;
}

/// How much of a part nothing lies on: seen, among what faces the camera.
void DetectionGrasps::allow(Grasp&& grasp, std::size_t g)
{
  GraspCandidate candidate;
  candidate.score = detection_.score;
  candidate.uncovered = detection_.visible_fraction;
  candidate.priority = part_.grasps[g].priority_share;
  candidate.height = grasp.tip.grasp.translation().dot(s_.up_camera);
  candidate.grasp = std::move(grasp);
  allowed.push_back(std::move(candidate));
}

void DetectionGrasps::list(Grasp&& grasp, std::size_t g)
{
  listed_[part_.grasps[g].as_written].set(static_cast<std::size_t>(grasp.rejection));
  rejected.push_back(std::move(grasp));
}
}  // namespace bin_picking
