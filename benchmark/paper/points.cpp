// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <limits>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/evaluation/pose_error.hpp"
#include "bin_picking_perception/refinement/verification.hpp"
#include "experiments.hpp"
#include "pictures.hpp"
#include "point_scene.hpp"

namespace bin_picking::paper
{
namespace
{
constexpr std::size_t RATED_POINTS = 4000;  // of the object in the scene, for Equation 9

std::vector<Eigen::Vector3f> thinned(const std::vector<Eigen::Vector3f>& points, std::size_t most)
{
  std::vector<Eigen::Vector3f> kept;
  const std::size_t step = (points.size() + most - 1) / most;
  for (std::size_t i = 0; i < points.size(); i += std::max<std::size_t>(1, step))
    kept.push_back(points[i]);
  return kept;
}

/// Mean distance of corresponding points (ADD), in the symmetric equivalent that fits best.
double addOf(const TrainedModel& model, const Pose& estimate, const Pose& truth)
{
  constexpr int TURNS = 72;  // of an axis of revolution
  double least = std::numeric_limits<double>::infinity();
  for (const Pose& same : model.symmetry.sampled(TURNS))
    least = std::min(least, averageDistance(model.points.points, estimate * same, truth));
  return least;
}

/// Equation 9 with the points that truly are the object's, so that no method chooses its own denominator.
void rate(Json& run, const Detection& found, const TrainedModel& model, const PointScene& scene, double match_distance)
{
  run["rate"] = matchingRate(KdTree(model.surface.points), found.T_camera_object,
                             thinned(scene.of_object, RATED_POINTS), match_distance);
  run["claimed_rate"] = found.matching_rate;
  run["add"] = addOf(model, found.T_camera_object, scene.T_camera_object) / model.diameter;
  const PoseError error = poseError(found.T_camera_object, scene.T_camera_object, model.symmetry, model.center);
  run["translation"] = error.translation;
  run["rotation"] = error.rotation;
}

Json runMethod(const Method& method, const std::shared_ptr<const TrainedModel>& model, const PointScene& scene,
               bool scene_is_part, Detection& best)
{
  const Detector detector({model}, method.detector);
  const double begin = processorSeconds();
  const DetectionResult result = detector.match(scene.points, scene_is_part);
  Json run = {{"ms", 1e3 * (processorSeconds() - begin)},
              {"seen_share", scene.seen_share},
              {"visible_share", scene.visible_share}};
  for (const char* stage : {"votes", "pairs", "references", "samples"})
    run[stage] = countOf(result, stage);
  // Whether a pose is good enough is for the figures to say, not for a threshold of the detector.
  const std::vector<Detection>& poses = result.detections.empty() ? result.rejected : result.detections;
  if (poses.empty())
    return run;
  best = poses.front();
  rate(run, best, *model, scene, method.detector.verification.match_distance);
  return run;
}

void drawResult(const std::string& file, const PointScene& scene, const TrainedModel& model, const Detection& found)
{
  const OrientedPoints placed = transformed(model.surface, found.T_camera_object);
  saveCloudPicture({{scene.points, {0.95f, 0.95f, 0.95f}}, {placed, {0.1f, 0.75f, 0.25f}}}, file);
}
/// What is the same for every scene of an experiment.
struct PointExperiment
{
  std::vector<PointObject> objects;
  std::vector<Method> methods;
  std::vector<std::shared_ptr<const TrainedModel>> models;  ///< per method
  bool scene_is_part = false;
  std::string picture;  ///< file without ending, for the next scene; empty: none
};

void runMethods(const PointExperiment& experiment, const PointScene& scene, const Json& labels, Json& runs)
{
  for (std::size_t m = 0; m < experiment.methods.size(); ++m)
  {
    Detection best;
    Json run = runMethod(experiment.methods[m], experiment.models[m], scene, experiment.scene_is_part, best);
    run["method"] = m;
    run.update(labels);
    if (!experiment.picture.empty() && run.contains("rate"))
      drawResult(experiment.picture + "_" + std::to_string(m) + ".png", scene, *experiment.models[m], best);
    runs.push_back(run);
  }
}

PointExperiment prepare(const Json& specification, const std::string& folder)
{
  PointExperiment experiment;
  for (const Json& object : specification.at("objects"))
    experiment.objects.push_back(readObject(object, folder));
  const Executor executor(0);
  Models models(executor, specification.value("models", ""));
  for (const Json& json : specification.at("methods"))
  {
    experiment.methods.push_back(readMethod(json));
    experiment.methods.back().detector.num_threads = 1;
    experiment.models.push_back(models.get(experiment.objects.front().part, experiment.methods.back()));
  }
  experiment.picture = specification.value("picture", "");
  return experiment;
}
}  // namespace

Json runPoints(const Json& specification, const std::string& folder)
{
  PointExperiment experiment = prepare(specification, folder);
  Json result = {
      {"models", Json::array()}, {"runs", Json::array()}, {"resolution", experiment.objects.front().resolution}};
  for (const auto& model : experiment.models)
    result["models"].push_back(describe(*model));
  if (specification.at("scene").is_object())
  {
    const PointScene scene = readPointScene(specification.at("scene"), experiment.objects.front());
    runMethods(experiment, scene, {{"noise", 0}, {"trial", 0}}, result["runs"]);
    return result;
  }
  const SceneKind kind = parseSceneKind(specification.at("scene").get<std::string>());
  experiment.scene_is_part = kind == SceneKind::Whole;
  for (const double noise : specification.value("noise", std::vector<double>{0.0}))
    for (int trial = 0; trial < specification.value("trials", 3); ++trial)
    {
      const auto seed = static_cast<std::uint32_t>(specification.value("seed", 1) + trial);
      const PointScene scene = makePointScene(experiment.objects, kind, noise, seed);
      runMethods(experiment, scene, {{"noise", noise}, {"trial", trial}}, result["runs"]);
      experiment.picture.clear();
    }
  return result;
}
}  // namespace bin_picking::paper
