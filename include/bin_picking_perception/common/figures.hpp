// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>

namespace bin_picking
{
/// Rounded to so many digits behind the point (0 to 9), whatever the locale: "12.30". Takes a fraction of a
/// microsecond, since thousands of sentences are written for a cloud. Not finite: "nan", "inf", "-inf".
std::string roundedText(double value, int digits);

/// "12.3 mm" of 0.0123 m.
std::string millimetres(double metres, int digits = 1);

/// "45.0 deg" of 0.7854 rad.
std::string degrees(double radians, int digits = 1);

/// "97.5 %" of 0.975.
std::string percent(double share, int digits = 1);
}  // namespace bin_picking
