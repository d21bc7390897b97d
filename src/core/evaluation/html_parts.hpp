// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>

#include "bin_picking_perception/evaluation/statistics.hpp"

namespace bin_picking
{
/// Text that may stand between tags and in attributes.
std::string escaped(const std::string& text);

std::string base64(const std::string& bytes);

/// With so many digits after the point; a dash for what is not a number.
std::string decimal(double value, int digits);

/// "97.5 %"; a dash if nothing was counted.
std::string percent(double share);

/// "87–100 %", or nothing if nothing was counted.
std::string intervalText(const Ratio& ratio);

/// Inserted once into the page.
extern const char* const REPORT_STYLE;
extern const char* const REPORT_SCRIPT;
}  // namespace bin_picking
