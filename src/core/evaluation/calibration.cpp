// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
constexpr std::size_t TENTHS = 10;

std::size_t tenthOf(double score)
{
  if (!(score >= 0 && score <= 1))
    throw ParameterError("A score is " + std::to_string(score) +
                         ", but only those in [0, 1] can be probabilities; calibrate no others.");
  return std::min(static_cast<std::size_t>(score * TENTHS), TENTHS - 1);
}
}  // namespace

Calibration calibration(const std::vector<ScoredOutcome>& outcomes)
{
  Calibration result;
  result.count = static_cast<int>(outcomes.size());
  result.tenths.resize(TENTHS);
  for (const ScoredOutcome& outcome : outcomes)
  {
    CalibrationBin& tenth = result.tenths[tenthOf(outcome.score)];
    tenth.mean_score += outcome.score;  // the sum, for now
    tenth.right.count(outcome.right);
    const double miss = outcome.score - (outcome.right ? 1 : 0);
    result.brier_score += miss * miss;
  }
  for (CalibrationBin& tenth : result.tenths)
  {
    result.expected_error += std::abs(tenth.mean_score - tenth.right.hits);  // times the poses of the tenth
    tenth.mean_score /= tenth.right.total;
  }
  result.brier_score /= result.count;
  result.expected_error /= result.count;
  return result;
}
}  // namespace bin_picking
