// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "grasp_ranking.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace bin_picking
{
namespace
{
// The height counts fully at the highest grasp and not at all this far below it: parts on top are the least covered.
constexpr double HEIGHT_RANGE = 0.1;  // metres

// More distance to bin and neighbours than this, beyond what is required, is no better.
constexpr double AMPLE_CLEARANCE = 0.004;  // metres; nearly as far as Obstacles looks

// Symmetric copies differ by rounding errors only; they must count as equal for the order to be stated by the rule.
constexpr double QUALITY_STEP = 1e-6;

double share(double value) { return std::clamp(value, 0.0, 1.0); }

double qualityOf(const GraspCandidate& candidate, double highest, const GraspParameters& parameters)
{
  const Grasp& grasp = candidate.grasp;
  const double height = share(1 - (highest - candidate.height) / HEIGHT_RANGE);
  const double upright = parameters.max_tilt > 0 ? share(1 - grasp.tilt / parameters.max_tilt) : 1.0;
  const double clearance = share((grasp.clearance.distance - grasp.clearance.required) / AMPLE_CLEARANCE);
  const double sum = parameters.weight_score * share(candidate.score) + parameters.weight_height * height +
                     parameters.weight_priority * share(candidate.priority) +
                     parameters.weight_uncovered * share(candidate.uncovered) + parameters.weight_tilt * upright +
                     parameters.weight_clearance * clearance;
  const double weights = parameters.weight_score + parameters.weight_height + parameters.weight_priority +
                         parameters.weight_uncovered + parameters.weight_tilt + parameters.weight_clearance;
  return std::round(sum / weights / QUALITY_STEP) * QUALITY_STEP;
}
}  // namespace

std::vector<Grasp> rankGrasps(std::vector<GraspCandidate> candidates, const GraspParameters& parameters)
{
  double highest = -std::numeric_limits<double>::infinity();
  for (const GraspCandidate& candidate : candidates)
    highest = std::max(highest, candidate.height);

  std::vector<Grasp> grasps;
  grasps.reserve(candidates.size());
  for (GraspCandidate& candidate : candidates)
  {
    candidate.grasp.quality = qualityOf(candidate, highest, parameters);
    grasps.push_back(std::move(candidate.grasp));
  }
  std::stable_sort(grasps.begin(), grasps.end(), [](const Grasp& a, const Grasp& b) { return a.quality > b.quality; });
  return grasps;
}
}  // namespace bin_picking
