// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bin_picking_perception/evaluation/calibration.hpp"
#include "bin_picking_perception/evaluation/scene_judgement.hpp"
#include "bin_picking_perception/evaluation/statistics.hpp"

namespace bin_picking
{
/// Found instances among those that are at least so visible.
struct RecallAtLevel
{
  double level = 0;
  Ratio ratio;
  Ratio turn_known = {};  ///< the same without those whose pose leaves a turn open
};

/// How many of the first so many detections of a scene are true.
struct FirstPrecision
{
  int first = 1;
  Ratio ratio;
};

/// The figures of one part, or of all. docs/evaluation.md tells what each means.
struct EvaluationFigures
{
  std::string part;  ///< empty: all
  int scenes = 0;    ///< in which the part is searched for
  int instances = 0;
  int pickable = 0;  ///< at least as visible as the lowest level
  int right = 0;     ///< estimates by verdict
  int hidden = 0;
  int duplicates = 0;
  int wrong = 0;
  std::vector<RecallAtLevel> recall;
  Ratio precision;                          ///< hits among all estimates
  Ratio undetermined;                       ///< hits among the estimates that leave a turn open
  std::vector<FirstPrecision> first;        ///< 1, 3, 5; over scenes with a pickable instance
  std::optional<double> average_precision;  ///< of all: mean over the parts
  Ratio empty_scenes;                       ///< with a false detection, among scenes without an instance of the part
  int false_in_empty = 0;
  Spread translation;          ///< of the hits, metres
  Spread rotation;             ///< of the hits, rad
  Spread mean_distance;        ///< ADD-S of the hits, metres
  Calibration tested;          ///< scores of all poses that were tested in full against their truth
  Calibration returned;        ///< of those of them that were accepted
  Ratio mean_distance_recall;  ///< pickable instances found with ADD-S below the same share of the diameter
};

struct StageSpread
{
  std::string stage;
  Spread seconds;
};

struct EvaluationSummary
{
  EvaluationFigures all;
  std::vector<EvaluationFigures> parts;
  Spread total;                     ///< seconds per scene
  std::vector<StageSpread> stages;  ///< in order of the pipeline
};

/// \param parts names, in the order of the result
EvaluationSummary summarize(const std::vector<JudgedScene>& scenes, const std::vector<std::string>& parts,
                            const EvaluationParameters& parameters);

/// Instances of the scene that are visible enough to be asked for and that no estimate hits.
std::vector<std::size_t> missedInstances(const JudgedScene& scene, double lowest_level);
}  // namespace bin_picking
