// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>

namespace bin_picking
{
/// Rounded to so many digits behind the point (0 to 9), whatever the locale: "12.30". Takes a fraction of a
/// microsecond, since thousands of sentences are written for a cloud. Not finite: "nan", "inf", "-inf".
std::string roundedText(double value, int digits);

/// Rounded to at most so many digits behind the point (0 to 17), without an exponent, trailing zeros or a minus before
/// 0: "12.3".
std::string shortText(double value, int digits);

/// "0.817 m".
std::string metres(double value, int digits = 3);

/// "12.3 mm" of 0.0123 m.
std::string millimetres(double metres, int digits = 1);

/// "45.0 deg" of 0.7854 rad.
std::string degrees(double radians, int digits = 1);

/// "97.5 %" of 0.975.
std::string percent(double share, int digits = 1);

/// A figure and the limit that it misses, in words.
struct FigureAndLimit
{
  std::string figure;
  std::string limit;
};

/// With as many digits, `digits` or more, as it takes for the two to differ: not "3.0 mm, at least 3.0 mm". Signs are
/// left to the sentence, which tells the two apart where they differ. \param text one of those above
FigureAndLimit toldApart(double figure, double limit, std::string (*text)(double, int), int digits = 1);
}  // namespace bin_picking
