// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "pick_pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
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

std::string describe(const bin_picking::AvoidedPlace& place)
{
  return std::string("The last attempt to take the part there ended as \"") + bin_picking::toString(place.outcome) +
         "\"; it is avoided for " + std::to_string(std::lround(place.until - place.since)) + " s from then or until " +
         std::to_string(place.picks_left) + " more picks have changed the pile (avoid).";
}

/// Whether a grasp may be offered; otherwise it is given the reason why not.
using LastCheck = std::function<bool(bin_picking::Grasp&)>;

/// The first `max_grasps` grasps that pass; those before them that do not become rejected ones.
GraspSelection firstThatPass(GraspSelection selection, const LastCheck& passes, int max_grasps)
{
  GraspSelection kept;
  kept.rejected = std::move(selection.rejected);
  for (bin_picking::Grasp& grasp : selection.grasps)
  {
    if (kept.grasps.size() >= static_cast<std::size_t>(max_grasps))
      break;
    (passes(grasp) ? kept.grasps : kept.rejected).push_back(std::move(grasp));
  }
  return kept;
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
    case DetectionCode::Ok:
      break;
  }
  const bool only_avoided = anyAvoided(selection);
  return makeReturnCode(only_avoided ? ReturnCode::ALL_AVOIDED : ReturnCode::NO_PICKABLE, detection.message + grasps);
}
}  // namespace

PickPipeline::PickPipeline(Setup setup) : setup_(std::move(setup)), detector_(setup_.models, setup_.detector)
{
  if (setup_.robot)
    arm_.emplace(*setup_.robot);
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

GraspSelection PickPipeline::select(const PickResult& result, const PickRequest& request) const
{
  bin_picking::GraspParameters parameters = setup_.grasping;
  int max_grasps = parameters.max_grasps;
  if (request.max_grasps > 0)
    max_grasps = static_cast<int>(std::min(request.max_grasps, static_cast<std::size_t>(max_grasps)));
  parameters.max_grasps = std::numeric_limits<int>::max();  // cut after what is avoided has been taken out
  auto selection =
      bin_picking::selectGrasps(result.detection.detections, setup_.parts, setup_.grippers.find(request.gripper),
                                result.bin ? &*result.bin : nullptr, parameters, request.accept_undetermined_turn);
  const auto avoided = request.avoided ? request.avoided(result.centers)
                                       : std::vector<std::optional<bin_picking::AvoidedPlace>>(result.centers.size());
  const bool check_reach = arm_ && request.T_base_camera && !request.skip_reach;
  const auto passes = [&](bin_picking::Grasp& grasp) {
    if (check_reach)
      bin_picking::checkReach(grasp, *arm_, *request.T_base_camera, setup_.reach);
    const auto& place = avoided[grasp.detection_index];
    if (grasp.rejection == bin_picking::GraspRejection::None && place)
    {
      grasp.rejection = bin_picking::GraspRejection::Avoided;
      grasp.reason = describe(*place);
    }
    return grasp.rejection == bin_picking::GraspRejection::None;
  };
  return firstThatPass(std::move(selection), passes, max_grasps);
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
  result.gripper = setup_.grippers.find(request.gripper).name;
  result.detection = detector_.detect(points, query);
  for (const bin_picking::Detection& detection : result.detection.detections)
    result.centers.push_back(detection.T_camera_object * setup_.models.at(detection.model_index)->center);
  timing.insert(timing.end(), result.detection.timing.begin(), result.detection.timing.end());
  result.selection = timed("grasp selection", timing, [&] { return select(result, request); });
  result.detection.timing = std::move(timing);
  result.detection.total_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.code = judge(result.detection, result.selection);
  return result;
}
}  // namespace bin_picking_ros
