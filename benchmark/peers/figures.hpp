// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/evaluation/evaluation_summary.hpp"
#include "bin_picking_perception/evaluation/part_shape.hpp"
#include "bin_picking_perception/evaluation/statistics.hpp"
#include "trial.hpp"

namespace bin_picking::peers
{
struct PlannedTrial
{
  Trial trial;
  TrialOutcome outcome;
};

/// The first pose of a scan against the instance of which it is least far off.
struct FirstPose
{
  bool matched = false;  ///< before ICP, mean distance of corresponding points (ADD) < 0.1 diameter
  bool found = false;    ///< the same after ICP
  bool exact = false;    ///< ADD < 0.02 diameter
  PoseError error;       ///< of the final pose
};
FirstPose judgeFirst(const PeerResult& result, const EvaluationScene& scene, const PartShape& shape);

/// CPU seconds from the points to the poses.
double searchSeconds(const SceneOutcome& outcome);

/// What a program did with lone parts; scans without an outcome count as not found.
struct LoneFigures
{
  bool shows_matches = false;  ///< whether it tells its poses before ICP
  Ratio matched;
  Ratio found;
  Ratio exact;
  Spread translation;  ///< of those found, metres
  Spread rotation;     ///< rad
  Spread match;        ///< seconds
  Spread icp;
  Spread total;
  Spread ratio;            ///< of its total to the reference's for the same scan
  Spread training;         ///< seconds
  Spread training_memory;  ///< bytes
  Spread search_memory;
};

/// \param reference trials of the same scans, with whose times those of `trials` are compared
LoneFigures loneFigures(const std::vector<const PlannedTrial*>& trials,
                        const std::vector<const PlannedTrial*>& reference, const PartShapes& shapes);

struct BinFigures
{
  EvaluationFigures evaluation;
  Spread seconds;  ///< a bin
  Spread ratio;    ///< to the reference's for the same bin
};
BinFigures binFigures(const std::vector<const PlannedTrial*>& trials, const std::vector<const PlannedTrial*>& reference,
                      const PartShapes& shapes);

/// Exponent x of y ~ size^x, by least squares of the logarithms; NaN for fewer than two sizes.
double growthExponent(const std::vector<double>& sizes, const std::vector<double>& values);
}  // namespace bin_picking::peers
