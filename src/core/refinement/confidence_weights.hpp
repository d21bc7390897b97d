// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

// Written by benchmark/fit_confidence.sh --write, fitted to
// the tested poses of benchmark/regression.sh --bins 3 --seed 100000.
namespace bin_picking::confidence_weights
{
constexpr double CONSTANT = -24.36;
constexpr double INLIER_SHARE = 2.14;
constexpr double VIOLATION_SHARE = 10.97;
constexpr double SURFACE_SHARE = 21.41;
constexpr double OUTLINE_SHARE = 2.77;
constexpr double TURN_MARGIN = 0.82;
constexpr double BIN_PENETRATION = 471;
}  // namespace bin_picking::confidence_weights
