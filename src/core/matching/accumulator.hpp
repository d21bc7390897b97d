// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "bin_picking_perception/matching/voting.hpp"

namespace bin_picking
{
/// The two-dimensional accumulator of Section 2.2.3: rows are model points, columns are steps of alpha.
class Accumulator
{
public:
  Accumulator(std::size_t num_model_points, int num_angles);

  void clear();

  /// Adds the votes of table entries for a scene pair with this alpha_s; an entry of a weighted pair counts `weight`.
  void vote(const TableEntry* entries, std::uint32_t count, std::uint16_t alpha_s, std::uint32_t weight);

  struct Peak
  {
    int model_point = 0;
    float alpha = 0;  ///< rad
    double votes = 0;
  };

  /// The best cell of every row that reaches min_share of the best cell of all, strongest first (ties: lower row).
  /// \param sum_adjacent a cell counts together with its next neighbour in alpha, and alpha is interpolated between the
  /// two
  std::vector<Peak> peaks(bool sum_adjacent, double min_share) const;

private:
  static constexpr std::size_t ROW = 32;  ///< cells per row in memory, a cache line or two

  std::size_t num_rows_;
  std::uint32_t num_angles_;
  std::size_t row_size_;
  std::vector<std::uint32_t> cells_;
};
}  // namespace bin_picking
