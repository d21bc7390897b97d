// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "text_table.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/figures.hpp"

namespace bin_picking::peers
{
void TextTable::add(std::vector<std::string> row)
{
  if (row.size() != rows_.front().size())
    throw Error("a row of " + std::to_string(row.size()) + " cells is added to a table of " +
                std::to_string(rows_.front().size()) + " columns");
  rows_.push_back(std::move(row));
}

std::string TextTable::text() const
{
  std::vector<std::size_t> widths(rows_.front().size(), 3);
  for (const auto& row : rows_)
    for (std::size_t c = 0; c < row.size(); ++c)
      widths[c] = std::max(widths[c], row[c].size());
  std::ostringstream out;
  for (std::size_t r = 0; r < rows_.size(); ++r)
  {
    for (std::size_t c = 0; c < rows_[r].size(); ++c)
      out << "| " << (c == 0 ? std::left : std::right) << std::setw(static_cast<int>(widths[c])) << rows_[r][c] << " ";
    out << "|\n";
    if (r > 0)
      continue;
    for (std::size_t c = 0; c < widths.size(); ++c)
      out << "|" << std::string(widths[c] + 1, '-') << (c == 0 ? "-" : ":");
    out << "|\n";
  }
  return out.str();
}

std::string number(double value, int digits) { return std::isfinite(value) ? roundedText(value, digits) : "-"; }

std::string shortNumber(double value)
{
  const double size = std::abs(value);
  return number(value, size < 1 ? 3 : size < 10 ? 2 : size < 100 ? 1 : 0);
}

std::string share(const Ratio& ratio) { return std::to_string(ratio.hits) + "/" + std::to_string(ratio.total); }
}  // namespace bin_picking::peers
