// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "peer.hpp"

namespace bin_picking::peers
{
/// One program, trained once for a part, asked about some scans.
struct Trial
{
  std::size_t program = 0;  ///< into programs()
  PartDefinition part;
  double step = 0;  ///< sampling, share of the diameter; 0: as the program derives it itself
  std::vector<EvaluationScene> scenes;
  int max_poses = 1;  ///< per scan
  double limit = 60;  ///< CPU seconds for the training and for each scan
};

struct TrainingOutcome
{
  double seconds = 0;  ///< CPU
  double memory = 0;   ///< at most taken while it trained, bytes
  int points = 0;
};

struct SceneOutcome
{
  PeerResult result;
  double check_seconds = 0;  ///< CPU, of the depth check
  double memory = 0;         ///< at most taken beyond the model and the scan, bytes
};

struct TrialOutcome
{
  std::optional<TrainingOutcome> training;
  std::vector<SceneOutcome> scenes;  ///< of the trial's scenes the first so many; if fewer, `failure` tells why
  std::string failure;
};

/// In a process of its own.
TrialOutcome runTrial(const Trial& trial);

/// Truth and outcomes cross the border of the process as JSON; the report keeps them too.
nlohmann::json toJson(const Pose& pose);
nlohmann::json toJson(const TrainingOutcome& outcome);
nlohmann::json toJson(const SceneOutcome& outcome);
nlohmann::json toJson(const EvaluationScene& scene);
EvaluationScene sceneFromJson(const nlohmann::json& json);
}  // namespace bin_picking::peers
