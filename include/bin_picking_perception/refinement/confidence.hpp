// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

namespace bin_picking
{
/// What speaks for and against a refined pose, in numbers that mean the same for every part.
struct PoseQuality
{
  double visible_fraction = 0;  ///< PoseEvidence::visibleFraction
  double inlier_share = 0;      ///< PoseEvidence::inlierShare
  double violation_share = 0;   ///< PoseEvidence::violationShare
  double surface_share = 0;     ///< surfaceShare
  double outline_share = 0;     ///< OutlineEvidence::share
  double turn_margin = 0;  ///< RivalChoice::margin, or margin_beyond_turn where a turn is left open; infinity: there is
                           ///< no rival
  double bin_penetration = 0;  ///< metres; 0 without a bin
};

/// What the score is computed from, as it enters: clamped, logarithms and roots taken, and turned so that more never
/// speaks against the pose.
struct ConfidenceTerm
{
  const char* name = "";
  double value = 0;
};

std::vector<ConfidenceTerm> confidenceTerms(const PoseQuality& quality);

/// Probability that the pose is right (up to the turn that it leaves open, if it does), that is, that no point of the
/// part is off by more than a tenth of its diameter: the logistic function of a constant and the weighted sum of the
/// terms. The weights are fitted to poses, right and wrong, in virtual bins (benchmark/fit_confidence.sh;
/// confidence_weights.hpp says which). A real sensor of another kind shifts it; the order remains.
double confidence(const PoseQuality& quality);
}  // namespace bin_picking
