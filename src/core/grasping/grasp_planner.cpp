// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/grasp_planner.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "bin_picking_perception/common/error.hpp"
#include "candidate_checks.hpp"
#include "detection_grasps.hpp"
#include "prepared_part.hpp"

namespace bin_picking
{
namespace
{
/// Their number where there is none.
std::size_t indexOf(const std::string& name, const std::vector<PartDefinition>& parts)
{
  const auto part = std::find_if(parts.begin(), parts.end(), [&](const PartDefinition& p) { return p.name == name; });
  return static_cast<std::size_t>(part - parts.begin());
}

std::vector<PlacedPart> placedParts(const GraspPlanner::Scene& scene)
{
  std::vector<PlacedPart> parts;
  for (const Detection& detection : scene.detection.detections)
    parts.push_back({scene.models[detection.model_index].get(), detection.T_camera_object});
  return parts;
}

/// The detections whose part is known.
std::vector<DetectionGrasps> findable(const std::vector<PreparedPart>& parts, const GraspSurroundings& s)
{
  std::vector<DetectionGrasps> grasps;
  const std::vector<Detection>& detections = s.scene.detection.detections;
  grasps.reserve(detections.size());
  for (std::size_t i = 0; i < detections.size(); ++i)
  {
    const std::size_t part = indexOf(detections[i].part, s.setup.parts);
    if (part < parts.size())
      grasps.emplace_back(i, s.setup.parts[part], parts[part], s);
  }
  return grasps;
}

std::size_t mostGrasps(const GraspSurroundings& s)
{
  const auto most = static_cast<std::size_t>(s.setup.parameters.max_grasps);
  return s.request.max_grasps > 0 ? std::min(most, s.request.max_grasps) : most;
}

/// What is written comes first: turned and tilted copies only of parts that have nothing else, best detections first,
/// and only as long as there are few grasps. A fixed number at a time, so that threads change nothing.
void tryTurned(std::vector<DetectionGrasps>& grasps, std::size_t enough, const Executor& executor)
{
  constexpr std::size_t AT_A_TIME = 8;
  std::size_t allowed = 0;
  std::vector<DetectionGrasps*> without;
  for (DetectionGrasps& of_one : grasps)
  {
    allowed += of_one.allowed.size();
    if (of_one.isWithoutGrasp())
      without.push_back(&of_one);
  }
  for (std::size_t begin = 0; begin < without.size() && allowed < enough; begin += AT_A_TIME)
  {
    const std::size_t end = std::min(begin + AT_A_TIME, without.size());
    executor.forEach(end - begin, [&](std::size_t i) { without[begin + i]->tryTurned(); });
    for (std::size_t i = begin; i < end; ++i)
      allowed += without[i]->allowed.size();
  }
}

GraspSelection ranked(std::vector<DetectionGrasps>&& of_detections, std::size_t most, const GraspSurroundings& s)
{
  GraspSelection selection;
  std::size_t rejected = 0;
  for (const DetectionGrasps& grasps : of_detections)
    rejected += grasps.rejected.size();
  selection.rejected.reserve(rejected);
  std::vector<GraspCandidate> allowed;
  for (DetectionGrasps& grasps : of_detections)
  {
    std::move(grasps.allowed.begin(), grasps.allowed.end(), std::back_inserter(allowed));
    std::move(grasps.rejected.begin(), grasps.rejected.end(), std::back_inserter(selection.rejected));
  }
  selection.grasps = rankGrasps(std::move(allowed), s.setup.parameters);
  if (selection.grasps.size() > most)
    selection.grasps.resize(most);
  return selection;
}

/// nullptr: it is left out knowingly.
const DepthGrid* cloudOf(const GraspPlanner::Scene& scene)
{
  if (scene.without_cloud)
    return nullptr;
  if (!scene.detection.surroundings)
    throw ParameterError(
        "The collisions of the gripper are to be checked, but the detection has no surroundings, the measured cloud: "
        "pass on the whole result of Detector::detect(), or say that there is none (without_cloud).");
  return scene.detection.surroundings.get();
}

void checkParameters(GraspPlanner::Setup& setup)
{
  checkRanges(setup.parameters);
  if (setup.gripper.bodies.empty())
    throw ParameterError("The gripper \"" + setup.gripper.name +
                         "\" has no bodies, so that its way into the bin cannot be checked; describe its palm and "
                         "fingers in the gripper file.");
}
}  // namespace

GraspPlanner::GraspPlanner(Setup setup) : setup_(std::move(setup)), executor_(setup_.num_threads)
{
  checkParameters(setup_);
  if (setup_.robot)
    kinematics_.emplace(*setup_.robot);
  auto prepared = std::make_shared<std::vector<PreparedPart>>();
  for (const PartDefinition& part : setup_.parts)
    prepared->push_back(preparePart(part, setup_.gripper, setup_.parameters.continuous_symmetry_steps));
  prepared_ = std::move(prepared);
}

GraspSelection GraspPlanner::plan(const Scene& scene, const Request& request) const
{
  const bool with_reach = kinematics_ && request.check_reach;
  if (with_reach && !scene.T_base_camera)
    throw ParameterError("the reach of the robot is to be checked, but the camera's pose in its base is not given");
  if (scene.detection.detections.empty())
    return {};
  std::optional<Obstacles> obstacles;
  if (request.check_collision)
    obstacles.emplace(cloudOf(scene), scene.bin, placedParts(scene), setup_.parameters.obstacles, executor_);
  GraspSurroundings s{setup_, scene, request, obstacles ? &*obstacles : nullptr, with_reach ? &*kinematics_ : nullptr};
  if (scene.bin)
  {
    s.up_camera = scene.bin->T_camera_bin.linear().col(2);
    s.rim = (scene.bin->T_camera_bin.translation() + scene.bin->inner_size.z() * s.up_camera).dot(s.up_camera);
  }

  std::vector<DetectionGrasps> grasps = findable(*prepared_, s);
  executor_.forEach(grasps.size(), [&](std::size_t i) { grasps[i].tryAsWritten(); });
  const auto enough = static_cast<std::size_t>(setup_.parameters.enough_grasps);
  tryTurned(grasps, std::min(enough, mostGrasps(s)), executor_);
  return ranked(std::move(grasps), mostGrasps(s), s);
}
}  // namespace bin_picking
