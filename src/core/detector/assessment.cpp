// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <cmath>
#include <limits>

#include "../common/parameter_text.hpp"
#include "bin_picking_perception/refinement/icp.hpp"
#include "bin_picking_perception/refinement/rivals.hpp"
#include "stages.hpp"

namespace bin_picking
{
double poseScore(const PoseEvidence& evidence, double outline_share, const VerificationParameters& parameters)
{
  // The inlier share says how right the pose is, the visible fraction how sure that is, and the outline whether it is
  // the whole of the thing that was seen; no one of them ranks well alone.
  constexpr double OUTLINE_WEIGHT = 0.3;
  constexpr double VISIBLE_EXPONENT = 0.7;
  return evidence.inlierShare(parameters.unmeasured_weight) * std::pow(evidence.visibleFraction(), VISIBLE_EXPONENT) *
         (1 - OUTLINE_WEIGHT * (1 - outline_share));
}

double depthTolerance(const PreparedScene& scene, const TrainedModel& model, const VerificationParameters& parameters)
{
  return parameters.depth_tolerance * model.parameters.leaf + parameters.noise_tolerance * scene.noise;
}

namespace
{
constexpr std::size_t FINE_POINTS = 1500;
constexpr double OUTLINE_NOISE = 3;  // standard deviations that are no step in depth

IcpResult refine(const Hypothetical& pose, const PreparedScene& scene, const TrainedModel& model,
                 const IcpParameters& icp)
{
  const double leaf = model.parameters.leaf;
  switch (icp.method)
  {
    case IcpMethod::PointToPoint:
      return icpPointToPoint(model.surface, pose.region->samples, pose.T_camera_object, icp.max_distance * leaf, icp);
    case IcpMethod::Projective:
      return icpProjective(model.surface, facingPoints(model, pose.T_camera_object, FINE_POINTS / 2), scene.grid,
                           scene.normals, pose.T_camera_object, leaf, icp);
    case IcpMethod::None:
      break;
  }
  IcpResult unchanged;
  unchanged.T_camera_object = pose.T_camera_object;
  return unchanged;
}

/// The first criterion that fails is the reason of the rejection.
void require(Detection& detection, const Criterion& criterion)
{
  if (!criterion.passed() && detection.rejection.empty())
    detection.rejection = failureText(criterion);
  detection.criteria.push_back(criterion);
}

/// What speaks for and against a refined pose.
struct Findings
{
  PoseEvidence evidence;
  OutlineEvidence outline;
  double turn_margin = std::numeric_limits<double>::infinity();
  double surface_share = 0;
};

void judge(Detection& detection, const Findings& findings, const PreparedScene& scene, const TrainedModel& model,
           const VerificationParameters& parameters)
{
  require(detection, {"matching_rate", detection.matching_rate, parameters.min_matching_rate, false});
  if (!parameters.enabled)
    return;
  const double inlier_share = findings.evidence.inlierShare(parameters.unmeasured_weight);
  require(detection, {"inlier_share", inlier_share, parameters.min_inlier_share, false});
  require(detection, {"visible_fraction", detection.visible_fraction, parameters.min_visible_fraction, false});
  require(detection, {"violation_share", findings.evidence.violationShare(), parameters.max_violation_share, true});
  require(detection, {"score", detection.score, parameters.min_score, false});
  require(detection, {"outline_share", findings.outline.share(), parameters.min_outline_share, false});
  if (std::isfinite(findings.turn_margin))
    require(detection, {"turn_margin", findings.turn_margin, parameters.min_turn_margin, false});
  require(detection, {"surface_share", findings.surface_share, parameters.min_surface_share, false});
  if (scene.bin)
    require(detection, {"bin_penetration", binPenetration(model.surface, detection.T_camera_object, *scene.bin),
                        parameters.max_bin_penetration, true});
}

/// ICP; then, of the poses that look much the same, the one that the scene contradicts least.
Pose settle(const Hypothetical& pose, const PreparedScene& scene, const TrainedModel& model,
            const DetectorParameters& parameters, double& turn_margin)
{
  const Pose refined = refine(pose, scene, model, parameters.icp).T_camera_object;
  if (!parameters.verification.enabled)
    return refined;
  const RivalChoice choice = chooseAmongRivals(model, refined, scene.grid, scene.surroundings,
                                               depthTolerance(scene, model, parameters.verification));
  turn_margin = choice.margin;
  if (!choice.turned)
    return refined;
  return refine({choice.T_camera_object, pose.votes, pose.region}, scene, model, parameters.icp).T_camera_object;
}

}  // namespace

Assessed assess(const Hypothetical& pose, const PreparedScene& scene, const TrainedModel& model,
                const DetectorParameters& parameters, int comparison_cell)
{
  const VerificationParameters& verification = parameters.verification;
  const double leaf = model.parameters.leaf;
  const double near = depthTolerance(scene, model, verification);
  Findings findings;
  Assessed assessed;
  Detection& detection = assessed.detection;
  detection.part = model.name;
  detection.votes = pose.votes;
  const Pose T = settle(pose, scene, model, parameters, findings.turn_margin);
  detection.T_camera_object = T;
  const SurfaceIndices visible = visiblePoints(model, T);
  findings.evidence = gatherEvidence(model, thinned(visible, FINE_POINTS), T, scene.grid, scene.surroundings,
                                     scene.normals, near, verification);
  findings.outline =
      gatherOutlineEvidence(model, visible, T, scene.surroundings, leaf, leaf + OUTLINE_NOISE * scene.noise);
  if (verification.enabled)
    findings.surface_share = surfaceShare(model, T, scene.grid, near);
  detection.visible_fraction = findings.evidence.visibleFraction();
  detection.rms = findings.evidence.rms;
  detection.matching_rate = pose.region->is_candidate ? matchingRate(model.surface, T, pose.region->samples.points,
                                                                     verification.match_distance)
                                                      : findings.evidence.matchingRate();
  detection.score = verification.enabled ? poseScore(findings.evidence, findings.outline.share(), verification)
                                         : detection.matching_rate;
  judge(detection, findings, scene, model, verification);
  assessed.cells = coveredCells(findings.evidence.pixels, scene.grid.width, scene.reduction, comparison_cell);
  return assessed;
}
}  // namespace bin_picking
