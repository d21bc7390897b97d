// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/refinement/icp.hpp"
#include "rounds.hpp"
#include "stages.hpp"

namespace bin_picking
{
namespace
{
/// A few steps towards the surface: poses from votes are off by so much that right and wrong ones explain about alike.
Pose nudge(const Pose& T_camera_object, const PreparedScene& scene, const TrainedModel& model, IcpParameters icp)
{
  constexpr std::size_t NUDGE_PIXELS = 120;
  constexpr int NUDGE_STEPS = 3;
  if (icp.method != IcpMethod::DistanceField)
    return T_camera_object;
  icp.max_iterations = std::min(icp.max_iterations, NUDGE_STEPS);
  const MeasuredPart measured =
      measuredNear(model, T_camera_object, scene.grid, scene.normals, scene.edges, NUDGE_PIXELS);
  return icpDistanceField(model, measured, T_camera_object, icp).T_camera_object;
}

Ranked lookAt(const Hypothetical& pose, const PreparedScene& scene, const TrainedModel& model,
              const FacingPoints& facing, const DetectorParameters& parameters, int comparison_cell)
{
  const Pose T = nudge(pose.T_camera_object, scene, model, parameters.icp);
  // A leaf is forgiven before the pose is refined.
  const PoseEvidence evidence = gatherEvidence(facing.at(T), T, scene.grid, scene.surroundings, scene.normals,
                                               model.parameters.leaf, parameters.verification);
  return {{T, pose.votes, pose.region},
          promise(evidence, parameters.verification),
          coveredCells(evidence.pixels, scene.grid.width, scene.reduction, comparison_cell)};
}

/// All poses, most promising first, each place once.
std::vector<Ranked> rankPoses(const std::vector<Hypothetical>& poses, const PreparedScene& scene,
                              const TrainedModel& model, const DetectorParameters& parameters, int comparison_cell,
                              const Executor& executor)
{
  std::vector<Ranked> ranked(poses.size());
  if (!parameters.verification.enabled)  // the paper: what the votes put first
  {
    std::transform(poses.begin(), poses.end(), ranked.begin(), [](const Hypothetical& pose) {
      return Ranked{pose, 0, {}};
    });
    return ranked;
  }
  constexpr std::size_t COARSE_POINTS = 64;
  const FacingPoints facing(model, COARSE_POINTS);
  executor.forEach(poses.size(), [&](std::size_t i) {
    ranked[i] = lookAt(poses[i], scene, model, facing, parameters, comparison_cell);
  });
  std::stable_sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) { return a.score > b.score; });
  // Which of slight turns it is, the rivals tell. Of poses that other near symmetries lead to, the one that ranks first
  // need not end at the right turn.
  const SamePlace same_place(model, Turns::Slight);
  std::vector<Place> places;
  std::vector<Ranked> distinct;
  for (Ranked& candidate : ranked)
  {
    const Place place = same_place.of(candidate.pose.T_camera_object);
    if (same_place.isAmong(places, place))
      continue;
    places.push_back(place);
    distinct.push_back(std::move(candidate));
  }
  return distinct;
}
}  // namespace

int comparisonCell(const PointView& raw, const std::vector<std::shared_ptr<const TrainedModel>>& models)
{
  double leaf = 0;
  for (const auto& model : models)
    leaf = std::max(leaf, model->parameters.leaf);
  const double depth = medianDepth(raw);
  return depth > 0 ? std::max(1, static_cast<int>(std::lround(leaf / raw.pitch(depth)))) : 1;
}

std::vector<Assessed> refineAndVerify(const std::vector<Hypothetical>& poses, const PreparedScene& scene,
                                      const TrainedModel& model, const DetectorParameters& parameters,
                                      int comparison_cell, const Deadline& deadline, const Executor& executor,
                                      StageClock& clock, bool& partial)
{
  const VerificationParameters& verification = parameters.verification;
  const std::vector<Ranked> ranked = rankPoses(poses, scene, model, parameters, comparison_cell, executor);
  clock.lap("ranking");
  Rounds rounds(ranked, model);
  std::vector<Assessed> ready;
  std::vector<int> explained;
  int fruitless = 0;
  const std::size_t limit = verification.enabled ? static_cast<std::size_t>(verification.max_refined) : ranked.size();
  while (ready.size() < limit && fruitless < verification.fruitless_rounds)
  {
    // The paper refines every candidate.
    const std::vector<const Ranked*> round = verification.enabled ? rounds.next(explained, ready) : rounds.next();
    if (round.empty())
      break;
    if (deadline.passed())
    {
      partial = true;
      break;
    }
    std::vector<Assessed> assessed(round.size());
    executor.forEach(round.size(), [&](std::size_t i) {
      assessed[i] = assess(round[i]->pose, scene, model, parameters, comparison_cell);
    });
    ++fruitless;
    for (Assessed& candidate : assessed)
    {
      if (candidate.detection.rejection.empty())
      {
        fruitless = 0;
        explained.insert(explained.end(), candidate.cells.begin(), candidate.cells.end());
      }
      ready.push_back(std::move(candidate));
    }
    std::sort(explained.begin(), explained.end());
  }
  clock.count("refined", static_cast<double>(ready.size()));
  clock.lap("refinement");
  return ready;
}
}  // namespace bin_picking
