// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <string>

namespace bin_picking
{
/// With one digit after the point. By to_chars, since thousands of reasons are written for a cloud and a stream takes
/// microseconds.
inline std::string oneDigit(double value)
{
  std::array<char, 330> text;  // the longest finite number
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, 1).ptr;
  return {text.data(), end};
}

inline std::string millimetres(double metres) { return oneDigit(1e3 * metres) + " mm"; }
inline std::string degrees(double radians) { return oneDigit(radians * 180 / M_PI) + " deg"; }
inline std::string percent(double share) { return oneDigit(100 * share) + " %"; }
}  // namespace bin_picking
