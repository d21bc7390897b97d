// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/common/figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace bin_picking
{
std::string roundedText(double value, int digits)
{
  // With the digits written into the format, which the library reads faster than a star.
  const std::array<char, 5> format = {'%', '.', static_cast<char>('0' + std::clamp(digits, 0, 9)), 'f', '\0'};
  std::array<char, 330> text;  // the longest finite number has 309 digits before the point
  const int length = std::snprintf(text.data(), text.size(), format.data(), value);
  // The C locale of the program may write a comma.
  std::replace(text.data(), text.data() + length, ',', '.');
  return {text.data(), static_cast<std::size_t>(length)};
}

std::string millimetres(double metres, int digits) { return roundedText(1e3 * metres, digits) + " mm"; }
std::string degrees(double radians, int digits) { return roundedText(radians * 180 / M_PI, digits) + " deg"; }
std::string percent(double share, int digits) { return roundedText(100 * share, digits) + " %"; }
}  // namespace bin_picking
