// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "bin_picking_perception/refinement/confidence.hpp"
#include "bin_picking_perception/refinement/icp.hpp"
#include "bin_picking_perception/refinement/rivals.hpp"
#include "stages.hpp"

namespace bin_picking
{
double promise(const PoseEvidence& evidence, const VerificationParameters& parameters)
{
  // The inlier share says how right the pose is, the visible fraction how much there is to refine; neither ranks well
  // alone. A wrong pose on a plane explains much, but is seen through where it ends: that is what gives it away.
  const double through = 1 - evidence.violationShare();
  return evidence.inlierShare(parameters.unmeasured_weight) * std::sqrt(evidence.visibleFraction()) * through *
         through * through * through;
}

double depthTolerance(const PreparedScene& scene, const TrainedModel& model, const VerificationParameters& parameters)
{
  return parameters.depth_tolerance * model.parameters.leaf + parameters.noise_tolerance * scene.noise;
}

namespace
{
constexpr std::size_t COARSE_POINTS = 250;
constexpr std::size_t COARSE_PIXELS = 500;  // about half of them belong to the part
constexpr std::size_t ICP_PIXELS = 1500;
constexpr std::size_t TEST_POINTS = 1500;
constexpr double OUTLINE_NOISE = 3;  // standard deviations that are no step in depth

Pose icpOnField(const Pose& T_camera_object, std::size_t pixels, const PreparedScene& scene, const TrainedModel& model,
                const IcpParameters& icp)
{
  const MeasuredPart measured = measuredNear(model, T_camera_object, scene.grid, scene.normals, scene.edges, pixels);
  return icpDistanceField(model, measured, T_camera_object, icp).T_camera_object;
}

/// Half of the iterations, with few points: enough to see whether a pose is worth more.
Pose refineRoughly(const Hypothetical& pose, const PreparedScene& scene, const TrainedModel& model, IcpParameters icp)
{
  switch (icp.method)
  {
    case IcpMethod::PointToPoint:
      return icpPointToPoint(*scene.model_surface, pose.region->samples, pose.T_camera_object,
                             icp.max_distance * model.parameters.leaf, icp)
          .T_camera_object;
    case IcpMethod::DistanceField:
      icp.max_iterations = (icp.max_iterations + 1) / 2;
      return icpOnField(pose.T_camera_object, COARSE_PIXELS, scene, model, icp);
    case IcpMethod::None:
      break;
  }
  return pose.T_camera_object;
}

/// The last tenths of a millimetre, with every pixel.
Pose fitAmidErrors(const Pose& T_camera_object, const PreparedScene& scene, const TrainedModel& model,
                   const IcpParameters& icp)
{
  const double spacing = icp.error_spacing * scene.grid.pitch(1) / scene.reduction;
  if (spacing <= 0)
    return T_camera_object;
  const OrientedPoints surface = surfaceNear(model, T_camera_object, scene.grid, scene.normals);
  return fitBesideSmoothErrors(model, surface, T_camera_object, spacing, icp);
}

/// The other half, with all points and a narrow gate, and then the fit.
Pose polish(const Pose& T_camera_object, const PreparedScene& scene, const TrainedModel& model, IcpParameters icp)
{
  if (icp.method != IcpMethod::DistanceField)
    return T_camera_object;
  icp.max_iterations /= 2;
  icp.max_distance = icp.min_distance;
  return fitAmidErrors(icpOnField(T_camera_object, ICP_PIXELS, scene, model, icp), scene, model, icp);
}

/// Neither finer refinement nor another turn would save this pose.
bool isHopeless(const PoseEvidence& evidence, const VerificationParameters& parameters)
{
  constexpr double INLIER_SHARE = 0.85;  // of what is asked for
  constexpr double VISIBLE_SHARE = 0.85;
  return evidence.inlierShare(parameters.unmeasured_weight) < INLIER_SHARE * parameters.min_inlier_share ||
         evidence.visibleFraction() < VISIBLE_SHARE * parameters.min_visible_fraction;
}

/// The first criterion that fails is the reason of the rejection.
void require(Detection& detection, const Criterion& criterion)
{
  if (!criterion.passed() && detection.rejection.empty())
    detection.rejection = failureText(criterion);
  detection.criteria.push_back(criterion);
}

/// A small margin is no doubt where all else is sure: wrong poses leave more than their turn unexplained.
double requiredTurnMargin(double score, const VerificationParameters& parameters)
{
  constexpr double SURE_SCORE = 0.96;
  return score >= SURE_SCORE ? parameters.min_turn_margin / 2 : parameters.min_turn_margin;
}

void judge(Detection& detection, const PoseQuality& quality, const VerificationParameters& parameters)
{
  require(detection, {"matching_rate", detection.matching_rate, parameters.min_matching_rate, false});
  if (!parameters.enabled)
    return;
  require(detection, {"visible_fraction", detection.visible_fraction, parameters.min_visible_fraction, false});
  require(detection, {"inlier_share", quality.inlier_share, parameters.min_inlier_share, false});
  require(detection, {"violation_share", quality.violation_share, parameters.max_violation_share, true});
  require(detection, {"surface_share", quality.surface_share, parameters.min_surface_share, false});
  require(detection, {"outline_share", quality.outline_share, parameters.min_outline_share, false});
  if (std::isfinite(quality.turn_margin))
    require(detection, {"turn_margin", quality.turn_margin, requiredTurnMargin(detection.score, parameters), false});
  require(detection, {"bin_penetration", quality.bin_penetration, parameters.max_bin_penetration, true});
  require(detection, {"score", detection.score, parameters.min_score, false});
}

/// The dearest of the tests: only poses come to it that nothing else speaks against and of which enough is hidden. What
/// continues the surface in front of the part hides it.
void requireNoContinuation(Detection& detection, const PoseEvidence& evidence, const SurfaceIndices& tested,
                           const PreparedScene& scene, const TrainedModel& model,
                           const VerificationParameters& parameters)
{
  const bool can_fail = evidence.occluded > parameters.max_continued_share * evidence.explained;
  if (!parameters.enabled || !detection.rejection.empty() || !can_fail)
    return;
  const double share = continuedShare(model, tested, detection.T_camera_object, scene.grid, scene.normals,
                                      depthTolerance(scene, model, parameters));
  require(detection, {"continued_share", share, parameters.max_continued_share, true});
}

/// Of the poses that look much the same, the one that the scene contradicts least, polished.
/// \param pose that led to the rough one. \param undetermined_turn what it leaves open. \param turn_margin against all
/// others
Pose settle(const Hypothetical& pose, const Pose& rough, const PreparedScene& scene, const TrainedModel& model,
            const DetectorParameters& parameters, std::optional<UndeterminedTurn>& undetermined_turn,
            double& turn_margin)
{
  const VerificationParameters& verification = parameters.verification;
  if (!verification.enabled)
    return polish(rough, scene, model, parameters.icp);
  const RivalChoice choice =
      chooseAmongRivals(model, rough, scene.grid, scene.surroundings, depthTolerance(scene, model, verification),
                        verification.min_turn_margin, [&](const Pose& rival) {
                          return refineRoughly({rival, pose.votes, pose.region}, scene, model, parameters.icp);
                        });
  turn_margin = choice.margin;
  if (verification.accept_undetermined_turns && choice.undetermined_turn &&
      choice.margin_beyond_turn >= verification.min_turn_margin)
  {
    undetermined_turn = choice.undetermined_turn;
    turn_margin = choice.margin_beyond_turn;
  }
  return polish(choice.T_camera_object, scene, model, parameters.icp);
}

PoseEvidence evidenceAt(const Pose& T_camera_object, const SurfaceIndices& facing, const PreparedScene& scene,
                        const TrainedModel& model, const VerificationParameters& parameters)
{
  return gatherEvidence(testPoints(model, facing), T_camera_object, scene.grid, scene.surroundings, scene.normals,
                        depthTolerance(scene, model, parameters), parameters);
}

/// What is known of a pose that was given up early: enough for its reason.
void giveUp(Detection& detection, const PoseEvidence& evidence, const VerificationParameters& parameters)
{
  detection.visible_fraction = evidence.visibleFraction();
  detection.rms = evidence.rms;
  detection.matching_rate = evidence.matchingRate();
  require(detection,
          {"inlier_share", evidence.inlierShare(parameters.unmeasured_weight), parameters.min_inlier_share, false});
  require(detection, {"visible_fraction", detection.visible_fraction, parameters.min_visible_fraction, false});
}

/// Refined, settled among its rivals, and tested.
Assessed refineAndTest(const Hypothetical& pose, const PreparedScene& scene, const TrainedModel& model,
                       const DetectorParameters& parameters, int comparison_cell)
{
  const VerificationParameters& verification = parameters.verification;
  const double leaf = model.parameters.leaf;
  const double near = depthTolerance(scene, model, verification);
  PoseQuality quality;
  Assessed assessed;
  Detection& detection = assessed.detection;
  detection.part = model.name;
  detection.votes = pose.votes;
  const Pose rough = refineRoughly(pose, scene, model, parameters.icp);
  if (verification.enabled)
  {
    const PoseEvidence first = evidenceAt(rough, facingPoints(model, rough, COARSE_POINTS), scene, model, verification);
    if (isHopeless(first, verification))
    {
      detection.T_camera_object = rough;
      giveUp(detection, first, verification);
      return assessed;
    }
  }
  const Pose T = settle(pose, rough, scene, model, parameters, detection.undetermined_turn, quality.turn_margin);
  detection.T_camera_object = T;
  const SurfaceIndices visible = visiblePoints(model, T);
  const SurfaceIndices tested = thinned(visible, TEST_POINTS);
  const PoseEvidence evidence = evidenceAt(T, tested, scene, model, verification);
  quality.visible_fraction = evidence.visibleFraction();
  quality.inlier_share = evidence.inlierShare(verification.unmeasured_weight);
  quality.violation_share = evidence.violationShare();
  if (verification.enabled)
  {
    quality.outline_share =
        gatherOutlineEvidence(model, visible, T, scene.surroundings, leaf, leaf + OUTLINE_NOISE * scene.noise).share();
    quality.surface_share = surfaceShare(model, T, scene.grid, near);
    quality.bin_penetration = scene.bin ? binPenetration(model.surface, T, *scene.bin) : 0;
    detection.quality = quality;
  }
  detection.visible_fraction = evidence.visibleFraction();
  detection.rms = evidence.rms;
  detection.matching_rate =
      pose.region->is_candidate
          ? matchingRate(*scene.model_surface, T, pose.region->samples.points, verification.match_distance)
          : evidence.matchingRate();
  detection.score = verification.enabled ? confidence(quality) : detection.matching_rate;
  judge(detection, quality, verification);
  requireNoContinuation(detection, evidence, tested, scene, model, verification);
  assessed.cells = coveredCells(evidence.pixels, scene.grid.width, scene.reduction, comparison_cell);
  return assessed;
}

/// Whether what a rejected pose lacks may be no more than some steps of ICP. It is not where another turn explains as
/// much.
bool mayLackSteps(const Detection& detection)
{
  constexpr double MIN_SCORE = 0.3;  // hardly any with a lower one is near a right pose
  return !detection.rejection.empty() && detection.score > MIN_SCORE &&
         std::none_of(detection.criteria.begin(), detection.criteria.end(), [](const Criterion& criterion) {
           return criterion.name == "turn_margin" && !criterion.passed();
         });
}
}  // namespace

Assessed assess(const Hypothetical& pose, const PreparedScene& scene, const TrainedModel& model,
                const DetectorParameters& parameters, int comparison_cell)
{
  Assessed first = refineAndTest(pose, scene, model, parameters, comparison_cell);
  if (!parameters.verification.enabled || !mayLackSteps(first.detection))
    return first;
  Hypothetical again = pose;
  again.T_camera_object = first.detection.T_camera_object;
  Assessed second = refineAndTest(again, scene, model, parameters, comparison_cell);
  return second.detection.score > first.detection.score ? second : first;
}
}  // namespace bin_picking
