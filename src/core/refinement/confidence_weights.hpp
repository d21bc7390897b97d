// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

// Written by benchmark/fit_confidence.sh --write, fitted to
// 2771 poses, 628 of them right, of 7 part(s) in 38 scenes of benchmark/regression.sh --bins 3 --seed 100000.
namespace bin_picking::confidence_weights
{
constexpr double CONSTANT = -12.19;
constexpr double BIN_PENETRATION = 388.8;
constexpr double OUTLINE_SHARE = 0.64007;
constexpr double SURFACE_SHARE = 11.926;
constexpr double TURN_MARGIN = 1.3643;
constexpr double VIOLATION_SHARE = 12.798;
}  // namespace bin_picking::confidence_weights
