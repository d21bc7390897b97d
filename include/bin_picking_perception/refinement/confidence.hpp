// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

namespace bin_picking
{
/// What speaks for and against a refined pose, in numbers that mean the same for every part.
struct PoseQuality
{
  double inlier_share = 0;     ///< PoseEvidence::inlierShare
  double violation_share = 0;  ///< PoseEvidence::violationShare
  double surface_share = 0;    ///< surfaceShare
  double outline_share = 0;    ///< OutlineEvidence::share
  double turn_margin = 0;  ///< RivalChoice::margin, or margin_beyond_turn where a turn is left open; infinity: there is
                           ///< no rival
  double bin_penetration = 0;  ///< metres; 0 without a bin
};

/// Probability that the pose is right (up to the turn that it leaves open, if it does), that is, that no point of the
/// part is off by more than a tenth of its diameter: a logistic regression of the poses that were tested, right and
/// wrong, in the 42 virtual bins of `benchmark/regression.sh --bins 3 --seed 100000`. A real sensor of another kind
/// shifts it; the order remains.
double confidence(const PoseQuality& quality);
}  // namespace bin_picking
