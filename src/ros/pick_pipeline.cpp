// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "pick_pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "bin_picking_perception/common/parameters.hpp"
#include "cloud_conversion.hpp"

namespace bin_picking_ros
{
namespace
{
using bin_picking::DetectionCode;
using bin_picking::DetectionResult;
using bin_picking::GraspSelection;

/// Runs `work` and notes the time it took.
template <typename Work>
auto timed(const std::string& stage, std::vector<bin_picking::StageTime>& timing, Work work)
{
  const auto start = std::chrono::steady_clock::now();
  auto result = work();
  timing.push_back({stage, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()});
  return result;
}

ReturnCode judge(const DetectionResult& detection, const GraspSelection& selection)
{
  const std::string grasps = "; " + std::to_string(selection.grasps.size()) + " grasps allowed, " +
                             std::to_string(selection.rejected.size()) + " rejected";
  if (!selection.grasps.empty())
    return makeReturnCode(detection.partial ? ReturnCode::PARTIAL : ReturnCode::OK, detection.message + grasps);
  if (detection.partial)
    return makeReturnCode(ReturnCode::DEADLINE, "The deadline passed before a grasp was ready: " + detection.message);
  switch (detection.code)
  {
    case DetectionCode::BinEmpty:
      return makeReturnCode(ReturnCode::BIN_EMPTY, detection.message);
    case DetectionCode::NoMatch:
      return makeReturnCode(ReturnCode::NO_MATCH, detection.message);
    case DetectionCode::Ok:
      break;
  }
  return makeReturnCode(ReturnCode::NO_PICKABLE, detection.message + grasps);
}
}  // namespace

PickPipeline::PickPipeline(Setup setup) : setup_(std::move(setup)), detector_(setup_.models, setup_.detector) {}

void PickPipeline::requireParts(const std::vector<std::string>& names) const
{
  std::vector<std::string> known;
  for (const auto& model : setup_.models)
    known.push_back(model->name);
  for (const std::string& name : names)
  {
    if (std::find(known.begin(), known.end(), name) != known.end())
      continue;
    const std::string near = bin_picking::didYouMean(name, known);
    std::string loaded;
    for (const std::string& candidate : known)
      loaded += (loaded.empty() ? "" : ", ") + candidate;
    throw RequestError(ReturnCode::PART_UNKNOWN, "The part " + name + " is not loaded" +
                                                     (near.empty() ? "" : "; did you mean " + near + "?") +
                                                     " (loaded: " + loaded + ").");
  }
}

PickResult PickPipeline::run(const sensor_msgs::PointCloud2& cloud, const PickRequest& request) const
{
  requireParts(request.parts);
  const auto start = std::chrono::steady_clock::now();
  std::vector<bin_picking::StageTime> timing;
  const auto points = timed("conversion", timing, [&] { return toPclCloud(cloud); });

  bin_picking::Detector::Request query;
  query.bin = request.bin;
  query.parts = request.parts;
  query.deadline = request.deadline;
  query.keep_segmentation = request.keep_segmentation;

  PickResult result;
  result.cloud_header = cloud.header;
  result.bin = request.bin;
  result.detection = detector_.detect(points, query);
  timing.insert(timing.end(), result.detection.timing.begin(), result.detection.timing.end());
  bin_picking::GraspParameters grasping = setup_.grasping;
  if (request.max_grasps > 0)
    grasping.max_grasps = static_cast<int>(std::min(request.max_grasps, static_cast<std::size_t>(grasping.max_grasps)));
  result.selection = timed("grasp selection", timing, [&] {
    return bin_picking::selectGrasps(result.detection.detections, setup_.parts, setup_.gripper,
                                     request.bin ? &*request.bin : nullptr, grasping, request.accept_undetermined_turn);
  });
  result.detection.timing = std::move(timing);
  result.detection.total_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.code = judge(result.detection, result.selection);
  return result;
}
}  // namespace bin_picking_ros
