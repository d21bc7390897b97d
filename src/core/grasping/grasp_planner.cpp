// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/grasp_planner.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "bin_picking_perception/common/error.hpp"
#include "candidate_checks.hpp"
#include "grasp_ranking.hpp"

namespace bin_picking
{
namespace
{
/// One variant of one grasp of one detection.
struct Attempt
{
  Grasp grasp;
  bool open = false;  ///< nothing speaks against it so far
};

bool isNominal(const GraspVariant& variant) { return variant.tilt == 0 && variant.spin == 0; }

GraspWay wayThrough(const Pose& T_camera_grasp, const GraspDefinition& definition, const Eigen::Vector3d& away)
{
  const Eigen::Vector3d approach = T_camera_grasp.linear().col(2);
  GraspWay way;
  way.pre_grasp = Eigen::Translation3d(-definition.approach * approach) * T_camera_grasp;
  way.grasp = T_camera_grasp;
  way.retreat = Eigen::Translation3d(definition.retreat * away) * T_camera_grasp;
  return way;
}

GraspWay moved(const GraspWay& way, const Pose& T_tip_other)
{
  return {way.pre_grasp * T_tip_other, way.grasp * T_tip_other, way.retreat * T_tip_other};
}

/// Not finite where the gripper does not have the width: such a grasp is refused.
GraspWay flangeWay(const GraspWay& tip, double width, const Gripper& gripper)
{
  Pose T_tip_tool0 = Pose::Identity();
  if (width >= gripper.min_opening && width <= gripper.max_opening)
    T_tip_tool0 = gripper.T_tool0_tip(width).inverse();
  else
    T_tip_tool0.translation().setConstant(std::numeric_limits<double>::quiet_NaN());
  return moved(tip, T_tip_tool0);
}

Grasp makeGrasp(const Detection& detection, std::size_t index, const GraspDefinition& definition,
                const GraspVariant& variant, const GraspSurroundings& s)
{
  Grasp grasp;
  grasp.part = detection.part;
  grasp.grasp_id = definition.id;
  grasp.detection_index = index;
  grasp.symmetry_variant = variant.symmetry_variant;
  grasp.tilted = variant.tilt;
  grasp.spun = variant.spin;
  const Pose T_camera_grasp = detection.T_camera_object * variant.T_object_tip;
  const Eigen::Vector3d approach = T_camera_grasp.linear().col(2);
  const Eigen::Vector3d away = s.scene.bin ? s.up_camera : Eigen::Vector3d(-approach);
  grasp.tip = wayThrough(T_camera_grasp, definition, away);
  grasp.tool0 = flangeWay(grasp.tip, definition.width, s.setup.gripper);
  grasp.T_tip_object = variant.T_tip_object;
  grasp.undetermined_turn = detection.undetermined_turn.has_value();
  grasp.width = definition.width;
  grasp.opening = definition.opening;
  grasp.priority = definition.priority;
  grasp.tilt = std::acos(std::clamp(-approach.dot(s.up_camera), -1.0, 1.0));
  return grasp;
}

const PartDefinition* definitionOf(const std::string& name, const std::vector<PartDefinition>& parts)
{
  const auto part = std::find_if(parts.begin(), parts.end(), [&](const PartDefinition& p) { return p.name == name; });
  return part == parts.end() ? nullptr : &*part;
}

/// Shares of the priority range of the part's grasps.
double priorityShare(int priority, const PartDefinition& part)
{
  const auto less = [](const GraspDefinition& a, const GraspDefinition& b) { return a.priority < b.priority; };
  const auto [lowest, highest] = std::minmax_element(part.grasps.begin(), part.grasps.end(), less);
  const double range = static_cast<double>(highest->priority) - lowest->priority;
  return range > 0 ? (static_cast<double>(priority) - lowest->priority) / range : 1.0;
}

/// What is checked at once for all copies of a grasp rules them all out: the first stands for them.
class Expansion
{
public:
  Expansion(const GraspSurroundings& s, const std::map<std::string, std::vector<GraspVariant>>& variants)
      : s_(s), variants_(variants)
  {}

  /// All variants of the kind that is wanted, with the cheap checks done.
  std::vector<Attempt> attempts(bool nominal) const
  {
    std::vector<Attempt> result;
    for (std::size_t i = 0; i < s_.scene.detection.detections.size(); ++i)
    {
      const Detection& detection = s_.scene.detection.detections[i];
      const PartDefinition* part = definitionOf(detection.part, s_.setup.parts);
      if (part)
        addAttempts(detection, i, *part, nominal, result);
    }
    return result;
  }

private:
  void addAttempts(const Detection& detection, std::size_t index, const PartDefinition& part, bool nominal,
                   std::vector<Attempt>& result) const
  {
    std::size_t ruled_out = part.grasps.size();  // index of the definition whose copies all fail
    for (const GraspVariant& variant : variants_.at(part.name))
    {
      if (isNominal(variant) != nominal || variant.grasp == ruled_out)
        continue;
      Attempt attempt{makeGrasp(detection, index, part.grasps[variant.grasp], variant, s_)};
      if (!checkDetection(attempt.grasp, s_))
        ruled_out = variant.grasp;
      else
        attempt.open = checkTilt(attempt.grasp, s_);
      result.push_back(std::move(attempt));
    }
  }

  const GraspSurroundings& s_;
  const std::map<std::string, std::vector<GraspVariant>>& variants_;
};

std::vector<PlacedPart> placedParts(const GraspPlanner::Scene& scene)
{
  std::vector<PlacedPart> parts;
  for (const Detection& detection : scene.detection.detections)
    parts.push_back({scene.models[detection.model_index].get(), detection.T_camera_object});
  return parts;
}

bool anyOpen(const std::vector<Attempt>& attempts)
{
  return std::any_of(attempts.begin(), attempts.end(), [](const Attempt& a) { return a.open; });
}

void checkWays(std::vector<Attempt>& attempts, const GraspSurroundings& s, const Executor& executor)
{
  executor.forEach(attempts.size(), [&](std::size_t i) {
    Attempt& attempt = attempts[i];
    attempt.open = attempt.open && checkCollision(attempt.grasp, s) && checkReach(attempt.grasp, s);
  });
}

/// How much of a part nothing lies on: seen, among what faces the camera.
GraspCandidate toCandidate(Grasp&& grasp, const GraspSurroundings& s)
{
  const Detection& detection = s.scene.detection.detections[grasp.detection_index];
  GraspCandidate candidate;
  candidate.score = detection.score;
  candidate.uncovered = detection.visible_fraction;
  candidate.priority = priorityShare(grasp.priority, *definitionOf(grasp.part, s.setup.parts));
  candidate.height = grasp.tip.grasp.translation().dot(s.up_camera);
  candidate.grasp = std::move(grasp);
  return candidate;
}

GraspSelection ranked(std::vector<Attempt>&& attempts, const GraspSurroundings& s)
{
  GraspSelection selection;
  std::vector<GraspCandidate> allowed;
  for (Attempt& attempt : attempts)
    if (attempt.open)
      allowed.push_back(toCandidate(std::move(attempt.grasp), s));
    else
      selection.rejected.push_back(std::move(attempt.grasp));
  selection.grasps = rankGrasps(std::move(allowed), s.setup.parameters);
  auto most = static_cast<std::size_t>(s.setup.parameters.max_grasps);
  if (s.request.max_grasps > 0)
    most = std::min(most, s.request.max_grasps);
  if (selection.grasps.size() > most)
    selection.grasps.resize(most);
  return selection;
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
  for (const PartDefinition& part : setup_.parts)
    variants_[part.name] = expandGrasps(part, setup_.parameters.continuous_symmetry_steps);
}

GraspSelection GraspPlanner::plan(const Scene& scene, const Request& request) const
{
  const bool with_reach = kinematics_ && request.check_reach;
  if (with_reach && !scene.T_base_camera)
    throw ParameterError("the reach of the robot is to be checked, but the camera's pose in its base is not given");
  std::optional<Obstacles> obstacles;
  if (request.check_collision)
    obstacles.emplace(scene.detection.surroundings.get(), scene.bin, placedParts(scene), setup_.parameters.obstacles,
                      executor_);
  const GraspSurroundings s{setup_,
                            scene,
                            request,
                            obstacles ? &*obstacles : nullptr,
                            with_reach ? &*kinematics_ : nullptr,
                            scene.bin ? Eigen::Vector3d(scene.bin->T_camera_bin.linear().col(2))
                                      : Eigen::Vector3d(-Eigen::Vector3d::UnitZ())};

  const Expansion expansion(s, variants_);
  std::vector<Attempt> attempts = expansion.attempts(true);
  checkWays(attempts, s, executor_);
  if (!anyOpen(attempts))  // what is written comes first: turned and tilted copies only where nothing else is left
  {
    std::vector<Attempt> others = expansion.attempts(false);
    checkWays(others, s, executor_);
    std::move(others.begin(), others.end(), std::back_inserter(attempts));
  }
  return ranked(std::move(attempts), s);
}

}  // namespace bin_picking
