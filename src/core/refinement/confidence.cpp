// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/refinement/confidence.hpp"

#include <algorithm>
#include <cmath>

namespace bin_picking
{
double confidence(const PoseQuality& quality)
{
  // Beyond these limits more is not better, or worse.
  constexpr double MOST_VIOLATION = 0.3;
  constexpr double LEAST_MARGIN = 0.03;
  constexpr double MOST_MARGIN = 300;
  constexpr double MOST_PENETRATION = 0.02;
  const double evidence = -24.36 + 2.14 * quality.inlier_share -
                          10.97 * std::min(quality.violation_share, MOST_VIOLATION) + 21.41 * quality.surface_share +
                          2.77 * quality.outline_share +
                          0.82 * std::log(std::clamp(quality.turn_margin, LEAST_MARGIN, MOST_MARGIN)) -
                          471 * std::min(quality.bin_penetration, MOST_PENETRATION);
  return 1 / (1 + std::exp(-evidence));
}
}  // namespace bin_picking
