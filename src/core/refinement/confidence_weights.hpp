// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

// Written by benchmark/fit_confidence.sh --write, fitted to
// 1175 poses, 678 of them right, of 7 part(s) in 38 scenes of benchmark/regression.sh --bins 3 --seed 100000.
namespace bin_picking::confidence_weights
{
constexpr double CONSTANT = -18.848;
constexpr double BIN_PENETRATION = 568.64;
constexpr double OUTLINE_SHARE = 5.14;
constexpr double SURFACE_SHARE = 16.698;
constexpr double TURN_MARGIN = 1.2287;
constexpr double VIOLATION_SHARE = 16.932;
}  // namespace bin_picking::confidence_weights
