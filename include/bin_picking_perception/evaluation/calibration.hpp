// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/evaluation/statistics.hpp"

namespace bin_picking
{
/// The poses of a tenth of the scores. Where scores are probabilities, `right` is `mean_score`.
struct CalibrationBin
{
  double mean_score = 0;  ///< NaN if it is empty
  Ratio right;
};

/// Whether scores are probabilities. NaN where there are no poses.
struct Calibration
{
  int count = 0;
  std::vector<CalibrationBin> tenths;  ///< k: scores from k / 10 to below (k + 1) / 10, the last one with 1
  double brier_score = 0;  ///< mean of (score - outcome)^2, the outcome 1 for right and 0 for wrong (Brier 1950)
  /// Mean over the poses of |mean score - share right| of their tenth (Naeini et al. 2015).
  double expected_error = 0;
};

/// \throws ParameterError a score outside of [0, 1]
Calibration calibration(const std::vector<ScoredOutcome>& outcomes);
}  // namespace bin_picking
