// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "bin_picking_perception/model/feature_table.hpp"

namespace bin_picking
{
/// The two-dimensional accumulator of Section 2.2.3: rows are the table's references, columns are steps of alpha. The
/// votes of a cell are 16 bits in two planes, of which the upper one is touched only by every 256th vote: so the other,
/// a byte a cell, stays in the processor's cache. A cell that is full stays full. In memory, columns lie one behind the
/// other, so that many rows are searched for their peaks at once.
class Accumulator
{
public:
  Accumulator(std::size_t num_references, int num_angles);

  void clear();

  /// Adds the votes of table entries for a scene pair with this alpha_s; an entry of a weighted pair counts `weight`.
  void vote(const TableEntry* begin, const TableEntry* end, std::uint16_t alpha_s, std::uint32_t weight);

  struct Peak
  {
    std::uint32_t row = 0;
    float alpha = 0;  ///< rad
    std::uint32_t votes = 0;
  };

  /// The best cells of the rows that reach min_share of the best cell of all, strongest first (ties: lower row): visits
  /// them until `visit(peak)` returns false. \param sum_adjacent a cell counts together with its next neighbour in
  /// alpha, and alpha is interpolated between the two
  template <typename Visit>
  void forEachPeak(bool sum_adjacent, double min_share, const Visit& visit)
  {
    // A heap, because mostly only the first few of many rows are wanted.
    for (findRows(sum_adjacent, min_share); !rows_.empty(); rows_.pop_back())
    {
      std::pop_heap(rows_.begin(), rows_.end());
      if (!visit(peakOf(~static_cast<std::uint32_t>(rows_.back()), sum_adjacent)))
        return;
    }
  }

private:
  void findRows(bool sum_adjacent, double min_share);
  void raiseToColumn(std::uint32_t column, bool sum_adjacent);
  std::uint32_t votesAt(std::uint32_t row, std::uint32_t column) const;
  Peak peakOf(std::uint32_t row, bool sum_adjacent) const;

  std::uint32_t num_rows_;
  std::uint32_t num_angles_;
  std::vector<std::uint8_t> low_;
  std::vector<std::uint8_t> high_;
  bool carried_ = false;                ///< whether any vote went to the upper plane
  std::vector<std::uint16_t> highest_;  ///< per row
  std::vector<std::uint64_t> rows_;     ///< heap: votes in the upper half, the inverted row in the lower one
};
}  // namespace bin_picking
