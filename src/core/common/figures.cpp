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
  constexpr double EXACT = 1e15;  // whole numbers below it are told apart by one
  const int places = std::clamp(digits, 0, 9);
  const double scaled = std::abs(value) * std::pow(10.0, places);
  if (!(scaled < EXACT))
  {
    std::array<char, 330> text;  // the longest finite number has 309 digits before the point
    return withPoint(text.data(), std::snprintf(text.data(), text.size(), "%.*f", places, value));
  }
  // As a whole number of the last place, which takes a tenth of the time.
  std::string text = std::to_string(static_cast<long long>(std::nearbyint(scaled)));
  const auto width = static_cast<std::size_t>(places);
  if (text.size() <= width)
    text.insert(0, width + 1 - text.size(), '0');
  if (places > 0)
    text.insert(text.size() - width, 1, '.');
  return std::signbit(value) ? "-" + text : text;
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
  const bool on_either_side = figure * limit < 0;  // the sentence says so: "into" one, "at least" the other
  figure = std::abs(figure);
  limit = std::abs(limit);
  FigureAndLimit told{text(figure, digits), text(limit, digits)};
  while (!on_either_side && figure != limit && digits < MOST_DIGITS && told.figure == told.limit)
  {
    ++digits;
    told = {text(figure, digits), text(limit, digits)};
  }
  return told;
}
}  // namespace bin_picking
