// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <cmath>
#include <cstdint>

#include "bin_picking_perception/common/figures.hpp"
#include "html_parts.hpp"

namespace bin_picking
{
std::string escaped(const std::string& text)
{
  std::string result;
  for (const char c : text)
  {
    switch (c)
    {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string base64(const std::string& bytes)
{
  constexpr const char* DIGITS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3)
  {
    const std::size_t left = bytes.size() - i;
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < left ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= left ? DIGITS[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string decimal(double value, int digits) { return std::isnan(value) ? "–" : roundedText(value, digits); }

std::string percent(double share) { return std::isnan(share) ? "–" : decimal(share * 100, 1) + " %"; }

std::string intervalText(const Ratio& ratio)
{
  if (ratio.total == 0)
    return "";
  const Interval interval = ratio.interval();
  return decimal(interval.low * 100, 0) + "–" + decimal(interval.high * 100, 0) + " %";
}
}  // namespace bin_picking
