// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/detector.hpp"

#include <algorithm>

#include "bin_picking_perception/common/error.hpp"
#include "stages.hpp"

namespace bin_picking
{
Detector::Detector(std::vector<std::shared_ptr<const TrainedModel>> models, DetectorParameters parameters)
    : models_(std::move(models)), parameters_(parameters), executor_(parameters_.num_threads)
{
  if (models_.empty())
    throw ParameterError("a detector needs at least one trained model, but none was given");
  // A value set in code may lie outside of its range: reading each back through the visitor checks it.
  DetectorParameters copy = parameters_;
  for (const auto& entry : listParameters(visitor(copy)))
    setParameter(visitor(copy), entry.path, entry.value);
  for (const auto& model : models_)
    surfaces_.push_back(std::make_shared<const KdTree>(model->surface.points));
}

std::vector<std::size_t> Detector::requestedModels(const Request& request) const
{
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < models_.size(); ++i)
    if (request.parts.empty() || std::count(request.parts.begin(), request.parts.end(), models_[i]->name) > 0)
      indices.push_back(i);
  std::vector<std::string> known;
  for (const auto& model : models_)
    known.push_back(model->name);
  for (const auto& part : request.parts)
    if (std::count(known.begin(), known.end(), part) == 0)
    {
      const std::string guess = didYouMean(part, known);
      throw ParameterError("the part '" + part + "' is not loaded" +
                           (guess.empty() ? "" : "; did you mean '" + guess + "'?"));
    }
  return indices;
}

DetectionResult Detector::detect(const pcl::PointCloud<pcl::PointXYZ>& cloud, const Request& request) const
{
  const auto start = std::chrono::steady_clock::now();
  const PointView points = viewOf(cloud, parameters_.input);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  DetectionResult result = detectIn(points, request);
  result.timing.insert(result.timing.begin(), {"input", seconds});
  result.total_seconds += seconds;
  return result;
}

namespace
{
SegmentationView viewOf(Segmentation&& segmentation, const std::vector<CandidateTarget>& candidates)
{
  SegmentationView view;
  view.width = segmentation.width;
  view.height = segmentation.height;
  view.gray = std::move(segmentation.gray);
  view.labels = std::move(segmentation.labels);
  view.candidates.assign(view.labels.size(), 0);
  for (std::size_t i = 0; i < view.labels.size(); ++i)
    for (const auto& candidate : candidates)
      if (candidate.label == view.labels[i])
        view.candidates[i] = candidate.label;
  return view;
}

void keepFinest(DepthGrid&& surroundings, DetectionResult& result)
{
  if (!result.surroundings || result.surroundings->size() < surroundings.size())
    result.surroundings = std::make_shared<const DepthGrid>(std::move(surroundings));
}
}  // namespace

DetectionResult Detector::detect(const DepthGrid& grid, const Request& request) const
{
  return detectIn(grid, request);
}

DetectionResult Detector::detectIn(const PointView& points, const Request& request) const
{
  const std::vector<std::size_t> indices = requestedModels(request);
  const Deadline deadline(request.deadline > 0 ? request.deadline : parameters_.deadline);
  const Bin* bin = request.bin ? &*request.bin : nullptr;
  DetectionResult result;
  StageClock clock(result);

  const int comparison_cell = comparisonCell(points, models_);
  std::vector<Assessed> assessed;
  BinContent content;
  for (const std::size_t index : indices)
  {
    const TrainedModel& model = *models_[index];
    PreparedScene scene = reduceScene(points, bin, model, parameters_, executor_, clock);
    const double measured = measuredPoints(scene);
    content.look(scene, parameters_.input);
    if (measured < parameters_.input.empty_bin_points)
    {
      keepFinest(std::move(scene.surroundings), result);
      continue;
    }
    clock.count("points", measured);
    scene.model_surface = surfaces_[index].get();
    Segmentation segmentation;
    executor_.forEach(2, [&](std::size_t side) {  // neither needs the other
      if (side == 0)
        describeScene(scene, model, parameters_, executor_, clock);
      else
        segmentation = segmentScene(scene.grid, parameters_.segmentation, bin, executor_);
    });
    clock.count("segments", static_cast<double>(segmentation.segments.size()));
    const auto candidates = selectCandidates(segmentation, scene.grid, model, parameters_.segmentation);
    clock.count("candidates", static_cast<double>(candidates.size()));
    const auto search = planSearch(scene, segmentation, candidates, model, parameters_);
    clock.lap("segmentation");
    const auto poses = searchPoses(search, &scene, model, parameters_, deadline, executor_, clock, result.partial);
    auto found =
        refineAndVerify(poses, scene, model, parameters_, comparison_cell, deadline, executor_, clock, result.partial);
    for (auto& pose : found)
      pose.detection.model_index = index;
    std::move(found.begin(), found.end(), std::back_inserter(assessed));
    if (request.keep_segmentation)
      result.segmentation = viewOf(std::move(segmentation), candidates);
    keepFinest(std::move(scene.surroundings), result);
  }
  selectDetections(std::move(assessed), parameters_, result);
  clock.lap("selection");
  // What lies beside the walls is searched too: only where that gave nothing does it pass for the walls themselves.
  if (content.isLittle(parameters_.input) && result.detections.empty() && !result.partial)
    content.describe(parameters_.input, result);
  else
    summarize(result);
  clock.finish();
  return result;
}
}  // namespace bin_picking
