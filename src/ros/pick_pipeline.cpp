// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "pick_pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
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

double secondsSince(std::chrono::steady_clock::time_point start)
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Runs `work` and notes the time it took.
template <typename Work>
auto timed(const std::string& stage, std::vector<bin_picking::StageTime>& timing, Work work)
{
  const auto start = std::chrono::steady_clock::now();
  auto result = work();
  timing.push_back({stage, secondsSince(start)});
  return result;
}

std::string describe(const bin_picking::AvoidedPlace& place)
{
  return std::string("The last attempt to take the part there ended as \"") + bin_picking::toString(place.outcome) +
         "\"; it is avoided for " + std::to_string(std::lround(place.until - place.since)) + " s from then or until " +
         std::to_string(place.picks_left) + " more picks have changed the pile (avoid).";
}

bool anyAvoided(const GraspSelection& selection)
{
  return std::any_of(selection.rejected.begin(), selection.rejected.end(), [](const bin_picking::Grasp& grasp) {
    return grasp.rejection == bin_picking::GraspRejection::Avoided;
  });
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
    case DetectionCode::BinUnseen:
      return makeReturnCode(ReturnCode::BAD_CLOUD, detection.message);
    case DetectionCode::Ok:
      break;
  }
  const auto code = anyAvoided(selection) ? ReturnCode::ALL_AVOIDED : ReturnCode::NO_PICKABLE;
  return makeReturnCode(code, detection.message + grasps);
}
}  // namespace

PickPipeline::PickPipeline(Setup setup) : setup_(std::move(setup)), detector_(setup_.models, setup_.detector)
{
  for (const bin_picking::Gripper& gripper : setup_.grippers.all())
    planners_.try_emplace(gripper.name, bin_picking::GraspPlanner::Setup{setup_.parts, gripper, setup_.robot,
                                                                         setup_.grasping, setup_.detector.num_threads});
}

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

GraspSelection PickPipeline::plan(const PickResult& result, const PickRequest& request) const
{
  const auto avoided = request.avoided ? request.avoided(result.centers)
                                       : std::vector<std::optional<bin_picking::AvoidedPlace>>(result.centers.size());
  bin_picking::GraspPlanner::Request query;
  query.accept_undetermined_turn = request.accept_undetermined_turn;
  query.check_collision = !request.skip_collision;
  query.check_reach = request.T_base_camera && !request.skip_reach;
  query.max_grasps = request.max_grasps;
  query.avoid = [&avoided](std::size_t detection) {
    return avoided[detection] ? describe(*avoided[detection]) : std::string();
  };
  const bin_picking::Bin* bin = result.bin ? &*result.bin : nullptr;
  return planners_.at(result.gripper).plan({result.detection, setup_.models, bin, request.T_base_camera}, query);
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
  if (request.deadline > 0)  // what the conversion has left of it; 0 would be none
    query.deadline = std::max(request.deadline - secondsSince(start), 1e-9);
  query.keep_segmentation = request.keep_segmentation;

  PickResult result;
  result.cloud_header = cloud.header;
  result.bin = request.bin;
  result.gripper = setup_.grippers.find(request.gripper).name;
  result.detection = detector_.detect(points, query);
  for (const bin_picking::Detection& detection : result.detection.detections)
    result.centers.push_back(detection.T_camera_object * setup_.models.at(detection.model_index)->center);
  timing.insert(timing.end(), result.detection.timing.begin(), result.detection.timing.end());
  result.selection = timed("grasp planning", timing, [&] { return plan(result, request); });
  result.detection.timing = std::move(timing);
  result.detection.total_seconds = secondsSince(start);
  result.code = judge(result.detection, result.selection);
  return result;
}
}  // namespace bin_picking_ros
