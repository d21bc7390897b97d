// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/common/figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace bin_picking
{
namespace
{
/// The C locale of the program may write a comma.
std::string withPoint(char* text, int length)
{
  std::replace(text, text + length, ',', '.');
  return {text, static_cast<std::size_t>(length)};
}
}  // namespace

std::string roundedText(double value, int digits)
{
  // With the digits written into the format, which the library reads faster than a star.
  const std::array<char, 5> format = {'%', '.', static_cast<char>('0' + std::clamp(digits, 0, 9)), 'f', '\0'};
  std::array<char, 330> text;  // the longest finite number has 309 digits before the point
  return withPoint(text.data(), std::snprintf(text.data(), text.size(), format.data(), value));
}

std::string shortText(double value, int digits)
{
  std::array<char, 350> buffer;
  std::string text =
      withPoint(buffer.data(), std::snprintf(buffer.data(), buffer.size(), "%.*f", std::clamp(digits, 0, 17), value));
  if (text.find('.') != std::string::npos)
    text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.')
    text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string metres(double value, int digits) { return roundedText(value, digits) + " m"; }
std::string millimetres(double metres, int digits) { return roundedText(1e3 * metres, digits) + " mm"; }
std::string degrees(double radians, int digits) { return roundedText(radians * 180 / M_PI, digits) + " deg"; }
std::string percent(double share, int digits) { return roundedText(100 * share, digits) + " %"; }

FigureAndLimit toldApart(double figure, double limit, std::string (*text)(double, int), int digits)
{
  constexpr int MOST_DIGITS = 9;
  figure = std::abs(figure);
  limit = std::abs(limit);
  while (figure != limit && digits < MOST_DIGITS && text(figure, digits) == text(limit, digits))
    ++digits;
  return {text(figure, digits), text(limit, digits)};
}
}  // namespace bin_picking
