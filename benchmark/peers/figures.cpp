// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "figures.hpp"

#include <cmath>
#include <limits>
#include <map>

#include "bin_picking_perception/evaluation/pose_error.hpp"
#include "bin_picking_perception/evaluation/scene_judgement.hpp"

namespace bin_picking::peers
{
namespace
{
constexpr double MAX_ERROR = 0.1;         // of the diameter
constexpr double MAX_EXACT_ERROR = 0.02;  // of the diameter

/// ADD modulo symmetry, to the nearest instance; \param nearest receives it
double meanDistance(const Pose& pose, const EvaluationScene& scene, const PartShape& shape, const Pose** nearest)
{
  double least = std::numeric_limits<double>::infinity();
  for (const TrueInstance& instance : scene.instances)
  {
    const Pose equivalent = nearestEquivalent(pose, instance.T_camera_object, shape.symmetry);
    const double distance = averageDistance(shape.surface_points, equivalent, instance.T_camera_object);
    if (distance >= least)
      continue;
    least = distance;
    *nearest = &instance.T_camera_object;
  }
  return least;
}

std::map<std::string, double> secondsByScan(const std::vector<const PlannedTrial*>& trials)
{
  std::map<std::string, double> seconds;
  for (const PlannedTrial* planned : trials)
    for (std::size_t k = 0; k < planned->outcome.scenes.size(); ++k)
      seconds[planned->trial.part.name + "/" + planned->trial.scenes[k].name] =
          searchSeconds(planned->outcome.scenes[k]);
  return seconds;
}

Spread ratios(const std::vector<const PlannedTrial*>& trials, const std::vector<const PlannedTrial*>& reference)
{
  const auto others = secondsByScan(reference);
  std::vector<double> ratios;
  for (const auto& [scan, seconds] : secondsByScan(trials))
    if (others.count(scan) > 0)
      ratios.push_back(seconds / others.at(scan));
  return spread(ratios);
}

/// What is measured of single trials and scans, in lists.
struct Samples
{
  std::vector<double> translation, rotation, match, icp, total, training, training_memory, search_memory;
};

void countScene(const PlannedTrial& planned, std::size_t k, const PartShapes& shapes, LoneFigures& figures,
                Samples& samples)
{
  const bool done = k < planned.outcome.scenes.size();
  const SceneOutcome nothing;
  const SceneOutcome& outcome = done ? planned.outcome.scenes[k] : nothing;
  const FirstPose first = judgeFirst(outcome.result, planned.trial.scenes[k], shapes.at(planned.trial.part.name));
  figures.shows_matches = figures.shows_matches || !outcome.result.matched.empty();
  figures.matched.count(first.matched);
  figures.found.count(first.found);
  figures.exact.count(first.exact);
  if (first.found)
  {
    samples.translation.push_back(first.error.translation);
    samples.rotation.push_back(first.error.rotation);
  }
  if (!done)
    return;
  samples.match.push_back(outcome.result.match_seconds);
  samples.icp.push_back(outcome.result.icp_seconds);
  samples.total.push_back(searchSeconds(outcome));
  samples.search_memory.push_back(outcome.memory);
}
}  // namespace

FirstPose judgeFirst(const PeerResult& result, const EvaluationScene& scene, const PartShape& shape)
{
  FirstPose first;
  const Pose* nearest = nullptr;
  if (!result.matched.empty())
    first.matched =
        meanDistance(result.matched.front().T_camera_object, scene, shape, &nearest) < MAX_ERROR * shape.diameter;
  if (result.poses.empty())
    return first;
  const Pose& pose = result.poses.front().T_camera_object;
  const double distance = meanDistance(pose, scene, shape, &nearest);
  first.found = distance < MAX_ERROR * shape.diameter;
  first.exact = distance < MAX_EXACT_ERROR * shape.diameter;
  if (nearest != nullptr)
    first.error = poseError(pose, *nearest, shape.symmetry, shape.center);
  return first;
}

double searchSeconds(const SceneOutcome& outcome)
{
  return outcome.result.match_seconds + outcome.result.icp_seconds + outcome.check_seconds;
}

LoneFigures loneFigures(const std::vector<const PlannedTrial*>& trials,
                        const std::vector<const PlannedTrial*>& reference, const PartShapes& shapes)
{
  LoneFigures figures;
  Samples samples;
  for (const PlannedTrial* planned : trials)
  {
    for (std::size_t k = 0; k < planned->trial.scenes.size(); ++k)
      countScene(*planned, k, shapes, figures, samples);
    if (!planned->outcome.training)
      continue;
    samples.training.push_back(planned->outcome.training->seconds);
    samples.training_memory.push_back(planned->outcome.training->memory);
  }
  figures.translation = spread(samples.translation);
  figures.rotation = spread(samples.rotation);
  figures.match = spread(samples.match);
  figures.icp = spread(samples.icp);
  figures.total = spread(samples.total);
  figures.training = spread(samples.training);
  figures.training_memory = spread(samples.training_memory);
  figures.search_memory = spread(samples.search_memory);
  figures.ratio = ratios(trials, reference);
  return figures;
}

BinFigures binFigures(const std::vector<const PlannedTrial*>& trials, const std::vector<const PlannedTrial*>& reference,
                      const PartShapes& shapes)
{
  const EvaluationParameters parameters;
  std::vector<JudgedScene> judged;
  std::vector<std::string> parts;
  std::vector<double> seconds;
  for (const PlannedTrial* planned : trials)
  {
    const std::string& part = planned->trial.part.name;
    parts.push_back(part);
    for (std::size_t k = 0; k < planned->trial.scenes.size(); ++k)
    {
      std::vector<PoseEstimate> estimates;
      if (k < planned->outcome.scenes.size())
      {
        for (const PeerPose& pose : planned->outcome.scenes[k].result.poses)
          estimates.push_back({part, pose.T_camera_object, pose.score});
        seconds.push_back(searchSeconds(planned->outcome.scenes[k]));
      }
      judged.push_back(judgeScene(planned->trial.scenes[k], estimates, shapes, parameters));
    }
  }
  return {summarize(judged, parts, parameters).all, spread(seconds), ratios(trials, reference)};
}

double growthExponent(const std::vector<double>& sizes, const std::vector<double>& values)
{
  double x_mean = 0;
  double y_mean = 0;
  const auto count = static_cast<double>(sizes.size());
  for (std::size_t i = 0; i < sizes.size(); ++i)
  {
    x_mean += std::log(sizes[i]) / count;
    y_mean += std::log(values[i]) / count;
  }
  double xx = 0;
  double xy = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i)
  {
    xx += (std::log(sizes[i]) - x_mean) * (std::log(sizes[i]) - x_mean);
    xy += (std::log(sizes[i]) - x_mean) * (std::log(values[i]) - y_mean);
  }
  return xx > 0 ? xy / xx : std::numeric_limits<double>::quiet_NaN();
}
}  // namespace bin_picking::peers
