// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "parameter_text.hpp"

#include <algorithm>
#include <array>
#include <clocale>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <locale>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
struct UnitFactor
{
  const char* suffix;
  const char* unit;
  double factor;
};

constexpr double PI = 3.14159265358979323846;
constexpr std::array<UnitFactor, 14> UNITS = {{{"mm", "m", 1e-3},
                                               {"cm", "m", 1e-2},
                                               {"um", "m", 1e-6},
                                               {"m", "m", 1},
                                               {"deg", "rad", PI / 180},
                                               {"rad", "rad", 1},
                                               {"/mm", "1/m", 1e3},
                                               {"1/mm", "1/m", 1e3},
                                               {"/m", "1/m", 1},
                                               {"1/m", "1/m", 1},
                                               {"ms", "s", 1e-3},
                                               {"s", "s", 1},
                                               {"%", "", 1e-2},
                                               {"", "", 1}}};

/// Reads a number in the C locale; `rest` receives what follows it.
bool readNumber(const std::string& text, double& number, std::string& rest)
{
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  // Streams stop at "1e" or swallow "inf"; the accepted form is digits with point and exponent.
  std::size_t end = text.find_first_not_of("+-.0123456789");
  if (end != std::string::npos && (text[end] == 'e' || text[end] == 'E') && end + 1 < text.size() &&
      text.find_first_of("+-0123456789", end + 1) == end + 1)
    end = text.find_first_not_of("0123456789", end + 2);
  const std::string digits = text.substr(0, end);
  std::istringstream digits_in(digits);
  digits_in.imbue(std::locale::classic());
  if (digits.empty() || !(digits_in >> number) || digits_in.peek() != std::istringstream::traits_type::eof())
    return false;
  rest = end == std::string::npos ? "" : text.substr(end);
  rest.erase(0, rest.find_first_not_of(' ') == std::string::npos ? rest.size() : rest.find_first_not_of(' '));
  return true;
}

std::size_t editDistance(const std::string& a, const std::string& b)
{
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j)
    row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i)
  {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j)
    {
      const std::size_t above = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row.back();
}
}  // namespace

std::string formatNumber(double value)
{
  for (int digits = 6; digits <= 17; ++digits)
  {
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out.precision(digits);
    out << value;
    double back = 0;
    std::istringstream in(out.str());
    in.imbue(std::locale::classic());
    if ((in >> back && back == value) || digits == 17)
      return out.str();
  }
  return {};
}

std::string rangeText(const ParameterInfo& info, const char* minus_infinity, const char* plus_infinity)
{
  if (std::isinf(info.min) && std::isinf(info.max))
    return "";
  return "[" + (std::isinf(info.min) ? minus_infinity : formatNumber(info.min)) + ", " +
         (std::isinf(info.max) ? plus_infinity : formatNumber(info.max)) + "]";
}

double parseQuantity(const std::string& text, const std::string& unit)
{
  double number = 0;
  std::string suffix;
  if (!readNumber(text, number, suffix))
    throw ParameterError("'" + text + "' is not a number");
  if (suffix.empty())
    return number;
  std::string fitting;
  for (const auto& candidate : UNITS)
  {
    // A curvature has the unit 1/m or none, by its measure.
    if (unit.find(candidate.unit) == std::string::npos || (unit.empty() != std::string(candidate.unit).empty()))
      continue;
    if (suffix == candidate.suffix && (unit == candidate.unit || unit.rfind(candidate.unit, 0) == 0))
      return number * candidate.factor;
    if (*candidate.suffix)
      fitting += (fitting.empty() ? "" : ", ") + std::string(candidate.suffix);
  }
  throw ParameterError("'" + text + "' has the unit '" + suffix + "', which does not fit" +
                       (fitting.empty() ? " a number without unit" : "; fitting ones are: " + fitting));
}

std::string didYouMean(const std::string& word, const std::vector<std::string>& known)
{
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const auto& candidate : known)
  {
    // A key given without its group is as good as a near one.
    const auto slash = candidate.rfind('/');
    const std::string last = slash == std::string::npos ? candidate : candidate.substr(slash + 1);
    const std::size_t distance =
        std::min(editDistance(word, candidate), editDistance(word, last) + (slash != std::string::npos));
    if (distance < best_distance)
    {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}
}  // namespace bin_picking
