// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <optional>
#include <vector>

namespace bin_picking
{
struct Interval
{
  double low = 0;
  double high = 1;
};

/// A share that was counted.
struct Ratio
{
  int hits = 0;
  int total = 0;

  void count(bool hit)
  {
    hits += hit;
    ++total;
  }
  /// NaN if nothing was counted.
  double value() const;
  /// In which the true share lies with 95 % confidence (Wilson 1927): honest for small samples and near 0 and 1, where
  /// the usual normal interval has no width. [0, 1] if nothing was counted.
  Interval interval() const;
};

/// NaN if there are no values.
struct Spread
{
  double median = 0;
  double p95 = 0;  ///< 95th percentile
  int count = 0;
};

/// Percentile with linear interpolation between neighbouring values; NaN for no values. \param share in [0, 1]
double percentile(std::vector<double> values, double share);
Spread spread(const std::vector<double>& values);

/// A detection for the precision-recall curve.
struct ScoredOutcome
{
  double score = 0;
  bool right = false;
};

/// Area under the precision-recall curve, where the precision at a recall is the best one at that recall or above
/// (all-point interpolation, as in PASCAL VOC from 2010 on). Outcomes of equal score enter together, so that their
/// order does not matter. \param positives instances that were to be found. \return nothing if there were none
std::optional<double> averagePrecision(std::vector<ScoredOutcome> outcomes, int positives);
}  // namespace bin_picking
