// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/refinement/confidence.hpp"

#include <algorithm>
#include <cmath>

#include "bin_picking_perception/refinement/rivals.hpp"
#include "confidence_weights.hpp"

namespace bin_picking
{
namespace
{
namespace weights = confidence_weights;

// Beyond these limits more is not better, or worse.
constexpr double MOST_VIOLATION = 0.3;
constexpr double LEAST_MARGIN = 1;
constexpr double MOST_PENETRATION = 0.02;

/// The inlier share is not among them: beside the visible fraction, violation and surface share it says nothing more.
struct Term
{
  const char* name;
  double weight;
  double (*value)(const PoseQuality&);
};

const Term TERMS[] = {
    {"violation_share", weights::VIOLATION_SHARE,
     [](const PoseQuality& q) { return -std::sqrt(std::min(q.violation_share, MOST_VIOLATION)); }},
    {"surface_share", weights::SURFACE_SHARE, [](const PoseQuality& q) { return q.surface_share; }},
    {"visible_fraction", weights::VISIBLE_FRACTION, [](const PoseQuality& q) { return q.visible_fraction; }},
    {"outline_share", weights::OUTLINE_SHARE, [](const PoseQuality& q) { return q.outline_share; }},
    {"turn_margin", weights::TURN_MARGIN,
     [](const PoseQuality& q) { return std::log(std::clamp(q.turn_margin, LEAST_MARGIN, MOST_MARGIN)); }},
    {"bin_penetration", weights::BIN_PENETRATION,
     [](const PoseQuality& q) { return -std::min(q.bin_penetration, MOST_PENETRATION); }},
};
}  // namespace

std::vector<ConfidenceTerm> confidenceTerms(const PoseQuality& quality)
{
  std::vector<ConfidenceTerm> terms;
  for (const Term& term : TERMS)
    terms.push_back({term.name, term.value(quality)});
  return terms;
}

double confidence(const PoseQuality& quality)
{
  double evidence = weights::CONSTANT;
  for (const Term& term : TERMS)
    evidence += term.weight * term.value(quality);
  return 1 / (1 + std::exp(-evidence));
}
}  // namespace bin_picking
