// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>

#include "bin_picking_perception/evaluation/calibration.hpp"

namespace bin_picking
{
/// A reliability diagram as a table: per tenth of the score where the share of right poses lies, and where it should
/// lie. Nothing if no poses were tested.
std::string calibrationSection(const Calibration& tested, const Calibration& returned);
}  // namespace bin_picking
