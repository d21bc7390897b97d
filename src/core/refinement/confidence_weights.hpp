// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

// Written by benchmark/fit_confidence.sh --write, fitted to
// 2305 poses, 1059 of them right, of 7 part(s) in 72 scenes of
// regression.sh --bins 3 --seed 100000 and --sensor stereo --bins 2 --seed 200000.
namespace bin_picking::confidence_weights
{
constexpr double CONSTANT = -15.093;
constexpr double BIN_PENETRATION = 448.98;
constexpr double OUTLINE_SHARE = 3.4554;
constexpr double SURFACE_SHARE = 14.308;
constexpr double TURN_MARGIN = 0.58465;
constexpr double VIOLATION_SHARE = 11.746;
constexpr double VISIBLE_FRACTION = 3.6123;
}  // namespace bin_picking::confidence_weights
