// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>

#include "bin_picking_perception/common/parameters.hpp"

namespace bin_picking
{
/// Shortest text that reads back as the same number.
std::string formatNumber(double value);

/// "[0, 1]"; infinite ends are written as given.
std::string rangeText(const ParameterInfo& info, const char* minus_infinity, const char* plus_infinity);
}  // namespace bin_picking
