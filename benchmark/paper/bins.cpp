// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/evaluation/detection_picture.hpp"
#include "bin_picking_perception/evaluation/evaluation_dataset.hpp"
#include "bin_picking_perception/evaluation/scene_judgement.hpp"
#include "bin_picking_perception/model/depth_renderer.hpp"
#include "experiments.hpp"

namespace bin_picking::paper
{
namespace
{
constexpr double ON_THE_PART = 0.003;    // metres: a measured point so near to the true surface is the part's
constexpr int MIN_SEGMENT_PIXELS = 200;  // of a true segment that is worth searching

std::vector<std::shared_ptr<const TrainedModel>> modelsFor(const EvaluationDataset& dataset, const Method& method,
                                                           Models& models)
{
  std::vector<std::shared_ptr<const TrainedModel>> all;
  for (const EvaluationPart& part : dataset.parts)
    all.push_back(models.get(part.definition, method));
  return all;
}

/// Per pixel the instance that was measured there, from the true poses; -1: none.
std::vector<std::int32_t> trueLabels(const EvaluationScene& scene, const DepthGrid& grid, const PartShapes& shapes)
{
  DepthRenderer renderer(grid.width, grid.height, grid.camera);
  for (std::size_t k = 0; k < scene.instances.size(); ++k)
    renderer.draw(shapes.at(scene.instances[k].part).mesh, scene.instances[k].T_camera_object,
                  static_cast<std::int32_t>(k));
  std::vector<std::int32_t> labels = renderer.labels();
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (!(std::abs(grid.z[i] - renderer.depth()[i]) < static_cast<float>(ON_THE_PART)))
      labels[i] = -1;
  return labels;
}

/// Every true segment is searched alone, for one part: what no segmentation can do better.
DetectionResult detectInTrueSegments(const Detector& detector, const EvaluationScene& scene, const DepthGrid& grid,
                                     const PartShapes& shapes)
{
  const std::vector<std::int32_t> labels = trueLabels(scene, grid, shapes);
  DetectionResult all;
  for (std::size_t k = 0; k < scene.instances.size(); ++k)
  {
    const auto label = static_cast<std::int32_t>(k);
    if (std::count(labels.begin(), labels.end(), label) < MIN_SEGMENT_PIXELS)
      continue;
    DepthGrid segment = grid;
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (labels[i] != label)
        segment.invalidate(static_cast<int>(i));
    Detector::Request request;
    request.parts = {scene.instances[k].part};
    const DetectionResult found = detector.detect(segment, request);
    if (!found.detections.empty())
      all.detections.push_back(found.detections.front());
    all.counts.insert(all.counts.end(), found.counts.begin(), found.counts.end());
  }
  std::stable_sort(all.detections.begin(), all.detections.end(),
                   [](const Detection& a, const Detection& b) { return a.score > b.score; });
  all.detections.resize(
      std::min(all.detections.size(), static_cast<std::size_t>(detector.parameters().max_detections)));
  return all;
}

DetectionResult detect(const Method& method, const Detector& detector, const EvaluationScene& scene,
                       const DepthGrid& grid, const PartShapes& shapes)
{
  if (method.true_segments)
    return detectInTrueSegments(detector, scene, grid, shapes);
  Detector::Request request;
  request.bin = scene.bin;
  request.parts = scene.parts;
  return detector.detect(grid, request);
}

Json judged(const EvaluationScene& scene, const DetectionResult& result, const PartShapes& shapes)
{
  std::vector<PoseEstimate> estimates;
  for (const Detection& d : result.detections)
    estimates.push_back({d.part, d.T_camera_object, d.score, d.undetermined_turn});
  const JudgedScene verdicts = judgeScene(scene, estimates, shapes, {});
  Json detections = Json::array();
  for (std::size_t k = 0; k < verdicts.estimates.size(); ++k)
  {
    const JudgedEstimate& estimate = verdicts.estimates[k];
    const Detection& d = result.detections[k];  // both are sorted by score
    Json json = {{"part", d.part},
                 {"rate", d.matching_rate},
                 {"score", d.score},
                 {"verdict", toString(estimate.verdict)},
                 {"votes", d.votes}};
    if (estimate.instance)
    {
      json["translation"] = estimate.error.translation;
      json["rotation"] = estimate.error.rotation;
      json["mssd"] = estimate.max_distance / shapes.at(d.part).diameter;
      json["visible"] = scene.instances[*estimate.instance].visible_fraction;
    }
    detections.push_back(json);
  }
  Json instances = Json::array();
  for (std::size_t k = 0; k < scene.instances.size(); ++k)
    instances.push_back(
        {{"visible", scene.instances[k].visible_fraction}, {"found", verdicts.found_by[k].has_value()}});
  return {{"detections", detections}, {"instances", instances}};
}

Json runMethod(const Method& method, const Detector& detector, const EvaluationScene& scene, const DepthGrid& grid,
               const PartShapes& shapes, DetectionResult& result)
{
  const double begin = processorSeconds();
  result = detect(method, detector, scene, grid, shapes);
  const double seconds = processorSeconds() - begin;
  Json run = judged(scene, result, shapes);
  run["ms"] = 1e3 * seconds;
  run["stages"] = Json::object();
  for (const auto& time : result.timing)
    run["stages"][time.stage] = run["stages"].value(time.stage, 0.0) + 1e3 * time.seconds;
  for (const char* stage : {"votes", "pairs", "references", "samples", "segments", "candidates", "clusters"})
    run[stage] = countOf(result, stage);
  return run;
}
}  // namespace

Json runBins(const Json& specification, const std::string&)
{
  DatasetSelection selection;
  selection.parts = specification.value("parts", std::vector<std::string>());
  selection.split = specification.value("split", "");
  selection.max_scenes = specification.value("max_scenes", 0);
  EvaluationDataset dataset = openDataset(specification.at("dataset").get<std::string>(), selection);
  const Executor executor(0);
  const PartShapes shapes = loadPartShapes(dataset, executor);
  Models models(executor, specification.value("models", ""));
  Json result = {{"models", Json::array()}, {"runs", Json::array()}, {"scenes", dataset.scenes.size()}};
  std::vector<Method> methods;
  std::vector<std::unique_ptr<Detector>> detectors;
  for (const Json& json : specification.at("methods"))
  {
    methods.push_back(readMethod(json));
    methods.back().detector.num_threads = 1;
    const auto trained = modelsFor(dataset, methods.back(), models);
    detectors.push_back(std::make_unique<Detector>(trained, methods.back().detector));
    result["models"].push_back(describe(*trained.front()));
  }
  for (std::size_t s = 0; s < dataset.scenes.size(); ++s)
  {
    EvaluationScene& scene = dataset.scenes[s];
    const DepthGrid grid = loadSceneGrid(scene, methods.front().detector.input);
    estimateVisibility(scene, grid, shapes);
    for (std::size_t m = 0; m < methods.size(); ++m)
    {
      DetectionResult found;
      Json run = runMethod(methods[m], *detectors[m], scene, grid, shapes, found);
      run["method"] = m;
      run["scene"] = scene.name;
      result["runs"].push_back(run);
      if (s == 0 && specification.contains("picture"))
        saveDetectionPicture(grid, found, detectors[m]->models(),
                             specification.at("picture").get<std::string>() + "_" + std::to_string(m) + ".jpg");
    }
  }
  return result;
}
}  // namespace bin_picking::paper
