// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <limits>

#include "../common/parameter_text.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/refinement/icp.hpp"
#include "bin_picking_perception/refinement/rivals.hpp"
#include "stages.hpp"

namespace bin_picking
{
namespace
{
constexpr std::size_t COARSE_POINTS = 250;
constexpr std::size_t FINE_POINTS = 1500;
constexpr double OUTLINE_NOISE = 3;  // standard deviations that are no step in depth

double score(const PoseEvidence& evidence, double outline_share, const VerificationParameters& parameters)
{
  // The inlier share says how right the pose is, the visible fraction how sure that is, and the outline whether it is
  // the whole of the thing that was seen; no one of them ranks well alone.
  constexpr double OUTLINE_WEIGHT = 0.3;
  constexpr double VISIBLE_EXPONENT = 0.7;
  return evidence.inlierShare(parameters.unmeasured_weight) * std::pow(evidence.visibleFraction(), VISIBLE_EXPONENT) *
         (1 - OUTLINE_WEIGHT * (1 - outline_share));
}

double tolerance(const PreparedScene& scene, const TrainedModel& model, const VerificationParameters& parameters)
{
  return parameters.depth_tolerance * model.parameters.leaf + parameters.noise_tolerance * scene.noise;
}

/// The poses that a quick look at the unrefined evidence puts first.
std::vector<Hypothetical> mostPromising(const std::vector<Hypothetical>& poses, const PreparedScene& scene,
                                        const TrainedModel& model, const VerificationParameters& parameters,
                                        const Executor& executor)
{
  const auto limit = static_cast<std::size_t>(parameters.max_refined);
  if (!parameters.enabled || poses.size() <= limit)
    return poses;
  constexpr double UNREFINED = 2;  // poses from votes are off by about a leaf
  std::vector<double> scores(poses.size());
  executor.forEach(poses.size(), [&](std::size_t i) {
    const OrientedPoints facing = facingPoints(model, poses[i].T_camera_object, COARSE_POINTS);
    scores[i] = score(gatherEvidence(facing, poses[i].T_camera_object, scene.grid, scene.surroundings, scene.normals,
                                     UNREFINED * tolerance(scene, model, parameters), parameters),
                      1, parameters);
  });
  std::vector<std::size_t> order(poses.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return scores[a] > scores[b]; });
  std::vector<Hypothetical> best;
  for (std::size_t i = 0; i < limit; ++i)
    best.push_back(poses[order[i]]);
  return best;
}

IcpResult refine(const Hypothetical& pose, const PreparedScene& scene, const TrainedModel& model,
                 const IcpParameters& icp)
{
  const double leaf = model.parameters.leaf;
  switch (icp.method)
  {
    case IcpMethod::PointToPoint:
      return icpPointToPoint(model.surface, pose.region->samples, pose.T_camera_object, icp.max_distance * leaf, icp);
    case IcpMethod::Projective:
      return icpProjective(facingPoints(model, pose.T_camera_object, FINE_POINTS / 2), scene.grid, scene.normals,
                           pose.T_camera_object, leaf, icp);
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
                                               tolerance(scene, model, parameters.verification));
  turn_margin = choice.margin;
  if (!choice.turned)
    return refined;
  return refine({choice.T_camera_object, pose.votes, pose.region}, scene, model, parameters.icp).T_camera_object;
}

Assessed assess(const Hypothetical& pose, const PreparedScene& scene, const TrainedModel& model,
                const DetectorParameters& parameters, int comparison_cell)
{
  const VerificationParameters& verification = parameters.verification;
  const double leaf = model.parameters.leaf;
  const double near = tolerance(scene, model, verification);
  Findings findings;
  Assessed assessed;
  Detection& detection = assessed.detection;
  detection.part = model.name;
  detection.votes = pose.votes;
  const Pose T = settle(pose, scene, model, parameters, findings.turn_margin);
  detection.T_camera_object = T;
  const OrientedPoints visible = visiblePoints(model, T);
  findings.evidence = gatherEvidence(thinned(visible, FINE_POINTS), T, scene.grid, scene.surroundings, scene.normals,
                                     near, verification);
  findings.outline = gatherOutlineEvidence(visible, T, scene.surroundings, leaf, leaf + OUTLINE_NOISE * scene.noise);
  if (verification.enabled)
    findings.surface_share = surfaceShare(model, T, scene.grid, near);
  detection.visible_fraction = findings.evidence.visibleFraction();
  detection.rms = findings.evidence.rms;
  detection.matching_rate = pose.region->is_candidate ? matchingRate(model.surface, T, pose.region->samples.points,
                                                                     verification.match_distance)
                                                      : findings.evidence.matchingRate();
  detection.score =
      verification.enabled ? score(findings.evidence, findings.outline.share(), verification) : detection.matching_rate;
  judge(detection, findings, scene, model, verification);
  assessed.cells = coveredCells(findings.evidence.pixels, scene.grid.width, scene.reduction, comparison_cell);
  return assessed;
}
}  // namespace

int comparisonCell(const DepthGrid& raw, const std::vector<std::shared_ptr<const TrainedModel>>& models)
{
  std::vector<float> depths;
  constexpr std::size_t EVERY = 31;  // enough for a median
  for (std::size_t i = 0; i < raw.size(); i += EVERY)
    if (!std::isnan(raw.z[i]))
      depths.push_back(raw.z[i]);
  double leaf = 0;
  for (const auto& model : models)
    leaf = std::max(leaf, model->parameters.leaf);
  if (depths.empty())
    return 1;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return std::max(1, static_cast<int>(std::lround(leaf / raw.pitch(static_cast<double>(*middle)))));
}

std::vector<Assessed> refineAndVerify(const std::vector<Hypothetical>& poses, const PreparedScene& scene,
                                      const TrainedModel& model, const DetectorParameters& parameters,
                                      int comparison_cell, const Deadline& deadline, const Executor& executor,
                                      StageClock& clock, bool& partial)
{
  const auto best = mostPromising(poses, scene, model, parameters.verification, executor);
  clock.lap("ranking");
  std::vector<Assessed> assessed(best.size());
  std::vector<std::uint8_t> skipped(best.size(), 0);
  executor.forEach(best.size(), [&](std::size_t i) {
    skipped[i] = deadline.passed();
    if (!skipped[i])
      assessed[i] = assess(best[i], scene, model, parameters, comparison_cell);
  });
  std::vector<Assessed> ready;
  for (std::size_t i = 0; i < best.size(); ++i)
    if (!skipped[i])
      ready.push_back(std::move(assessed[i]));
  partial = partial || ready.size() < best.size();
  clock.count("refined", static_cast<double>(ready.size()));
  clock.lap("refinement");
  return ready;
}

std::string failureText(const Criterion& criterion)
{
  return criterion.name + " is " + roundedText(criterion.value, 3) + ", but must be at " +
         (criterion.upper_limit ? "most " : "least ") + roundedText(criterion.required, 3);
}

void summarize(DetectionResult& result)
{
  const std::string late = result.partial ? "; the deadline passed, so this is what was ready" : "";
  result.code = result.detections.empty() ? DetectionCode::NoMatch : DetectionCode::Ok;
  if (result.detections.empty())
    result.message = "no part was recognised; the best of " + std::to_string(result.rejected.size()) +
                     " rejected poses: " + (result.rejected.empty() ? "none" : result.rejected.front().rejection) +
                     late;
  else
    result.message = std::to_string(result.detections.size()) + " part(s) found, the best with a score of " +
                     roundedText(result.detections.front().score, 2) + late;
}

void selectDetections(std::vector<Assessed> assessed, const DetectorParameters& parameters, DetectionResult& result)
{
  std::stable_sort(assessed.begin(), assessed.end(),
                   [](const Assessed& a, const Assessed& b) { return a.detection.score > b.detection.score; });
  std::vector<int> explained;  // by accepted detections, ascending
  for (auto& candidate : assessed)
  {
    Detection& detection = candidate.detection;
    std::vector<int> shared;
    std::set_intersection(candidate.cells.begin(), candidate.cells.end(), explained.begin(), explained.end(),
                          std::back_inserter(shared));
    const double overlap =
        static_cast<double>(shared.size()) / std::max<double>(1, static_cast<double>(candidate.cells.size()));
    if (detection.rejection.empty() && overlap > parameters.verification.overlap)
      detection.rejection = "a better detection explains " + roundedText(100 * overlap, 0) + " % of what it explains";
    if (detection.rejection.empty() && static_cast<int>(result.detections.size()) >= parameters.max_detections)
      detection.rejection = "max_detections better ones were found";
    if (!detection.rejection.empty())
    {
      if (static_cast<int>(result.rejected.size()) < parameters.max_rejected)
        result.rejected.push_back(std::move(detection));
      continue;
    }
    std::vector<int> merged;
    std::set_union(explained.begin(), explained.end(), candidate.cells.begin(), candidate.cells.end(),
                   std::back_inserter(merged));
    explained = std::move(merged);
    result.detections.push_back(std::move(detection));
  }
}
}  // namespace bin_picking
