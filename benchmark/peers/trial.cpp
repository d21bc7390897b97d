// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "trial.hpp"

#include <algorithm>

#include "bin_picking_perception/evaluation/statistics.hpp"
#include "child_process.hpp"
#include "depth_check.hpp"

namespace bin_picking::peers
{
namespace
{
// Short searches are repeated, so that their times are no accidents: up to so often, while the sum is below so many s.
constexpr int MAX_REPETITIONS = 5;
constexpr double REPETITION_SECONDS = 0.5;

Pose poseFrom(const nlohmann::json& json)
{
  Pose pose = Pose::Identity();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c)
      pose.matrix()(r, c) = json.at(static_cast<std::size_t>(4 * r + c)).get<double>();
  return pose;
}

nlohmann::json toJson(const std::vector<PeerPose>& poses)
{
  nlohmann::json json = nlohmann::json::array();
  for (const PeerPose& pose : poses)
    json.push_back({{"T_camera_object", peers::toJson(pose.T_camera_object)}, {"score", pose.score}});
  return json;
}

std::vector<PeerPose> posesFrom(const nlohmann::json& json)
{
  std::vector<PeerPose> poses;
  for (const nlohmann::json& entry : json)
    poses.push_back({poseFrom(entry.at("T_camera_object")), entry.at("score").get<double>()});
  return poses;
}

TrainingOutcome trainingFrom(const nlohmann::json& json)
{
  return {json.at("seconds").get<double>(), json.at("memory").get<double>(), json.at("points").get<int>()};
}

SceneOutcome outcomeFrom(const nlohmann::json& json)
{
  SceneOutcome outcome;
  outcome.result.matched = posesFrom(json.at("matched"));
  outcome.result.poses = posesFrom(json.at("poses"));
  outcome.result.match_seconds = json.at("match_seconds").get<double>();
  outcome.result.icp_seconds = json.at("icp_seconds").get<double>();
  outcome.result.scene_points = json.at("scene_points").get<int>();
  outcome.check_seconds = json.at("check_seconds").get<double>();
  outcome.memory = json.at("memory").get<double>();
  return outcome;
}

TrainingOutcome train(Peer& peer, const PeerModel& model, double step)
{
  resetPeakMemory();
  const double before = memory().resident;
  const double start = cpuSeconds();
  peer.train(model, step);
  return {cpuSeconds() - start, memory().peak - before, peer.modelPoints()};
}

/// The times of a repeated search are medians.
PeerResult findRepeatedly(Peer& peer, const PeerScene& scene)
{
  PeerResult result;
  std::vector<double> match;
  std::vector<double> icp;
  double sum = 0;
  while (match.empty() || (static_cast<int>(match.size()) < MAX_REPETITIONS && sum < REPETITION_SECONDS))
  {
    result = peer.find(scene);
    match.push_back(result.match_seconds);
    icp.push_back(result.icp_seconds);
    sum += result.match_seconds + result.icp_seconds;
  }
  result.match_seconds = spread(match).median;
  result.icp_seconds = spread(icp).median;
  return result;
}

SceneOutcome ask(Peer& peer, const PeerModel& model, const EvaluationScene& file, const Trial& trial)
{
  PeerScene scene = loadPeerScene(file, model);
  scene.max_poses = trial.max_poses;
  scene.max_seconds = 0.5 * trial.limit;
  SceneOutcome outcome;
  resetPeakMemory();
  const double before = memory().resident;
  outcome.result = findRepeatedly(peer, scene);
  outcome.memory = memory().peak - before;
  if (trial.max_poses > 1 && !peer.verifies())
  {
    const double start = cpuSeconds();
    outcome.result.poses = checkedByDepth(outcome.result.poses, model, scene);
    outcome.check_seconds = cpuSeconds() - start;
  }
  return outcome;
}
}  // namespace

nlohmann::json toJson(const Pose& pose)
{
  nlohmann::json json = nlohmann::json::array();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c)
      json.push_back(pose.matrix()(r, c));
  return json;
}

nlohmann::json toJson(const TrainingOutcome& outcome)
{
  return {{"seconds", outcome.seconds}, {"memory", outcome.memory}, {"points", outcome.points}};
}

nlohmann::json toJson(const SceneOutcome& outcome)
{
  return {{"matched", toJson(outcome.result.matched)},
          {"poses", toJson(outcome.result.poses)},
          {"match_seconds", outcome.result.match_seconds},
          {"icp_seconds", outcome.result.icp_seconds},
          {"scene_points", outcome.result.scene_points},
          {"check_seconds", outcome.check_seconds},
          {"memory", outcome.memory}};
}

nlohmann::json toJson(const EvaluationScene& scene)
{
  nlohmann::json instances = nlohmann::json::array();
  for (const TrueInstance& instance : scene.instances)
    instances.push_back(toJson(instance.T_camera_object));
  return {{"name", scene.name}, {"file", scene.file}, {"part", scene.parts.front()}, {"instances", instances}};
}

EvaluationScene sceneFromJson(const nlohmann::json& json)
{
  EvaluationScene scene;
  scene.name = json.at("name").get<std::string>();
  scene.file = json.at("file").get<std::string>();
  scene.parts = {json.at("part").get<std::string>()};
  for (const nlohmann::json& pose : json.at("instances"))
  {
    TrueInstance instance;
    instance.part = scene.parts.front();
    instance.T_camera_object = poseFrom(pose);
    instance.visible_fraction = 1;
    scene.instances.push_back(instance);
  }
  return scene;
}

TrialOutcome runTrial(const Trial& trial)
{
  TrialOutcome outcome;
  const auto work = [&](const LineSink& emit) {
    const PeerModel model = makePeerModel(trial.part);
    const std::unique_ptr<Peer> peer = programs()[trial.program].make();
    emit(toJson(train(*peer, model, trial.step)).dump());
    for (const EvaluationScene& scene : trial.scenes)
      emit(toJson(ask(*peer, model, scene, trial)).dump());
  };
  outcome.failure = runInChild(work, trial.limit, [&](const std::string& line) {
    const nlohmann::json json = nlohmann::json::parse(line);
    if (outcome.training)
      outcome.scenes.push_back(outcomeFrom(json));
    else
      outcome.training = trainingFrom(json);
  });
  return outcome;
}
}  // namespace bin_picking::peers
