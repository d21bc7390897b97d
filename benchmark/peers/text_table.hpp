// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/evaluation/statistics.hpp"

namespace bin_picking::peers
{
/// A Markdown table whose columns are also aligned for who reads it as text.
class TextTable
{
public:
  explicit TextTable(std::vector<std::string> header) : rows_{std::move(header)} {}
  /// \throws Error the row is not as long as the header
  void add(std::vector<std::string> row);
  std::string text() const;

private:
  std::vector<std::vector<std::string>> rows_;
};

/// "-" for NaN.
std::string number(double value, int digits);
/// Three significant digits, without exponent.
std::string shortNumber(double value);
/// "5/6".
std::string share(const Ratio& ratio);
}  // namespace bin_picking::peers
