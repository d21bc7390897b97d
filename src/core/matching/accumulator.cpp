// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "accumulator.hpp"

#include <algorithm>
#include <cmath>

namespace bin_picking
{
Accumulator::Accumulator(std::size_t num_model_points, int num_angles)
    : num_rows_(num_model_points),
      num_angles_(static_cast<std::uint32_t>(num_angles)),
      row_size_((static_cast<std::size_t>(num_angles) + ROW - 1) / ROW * ROW),
      cells_(num_model_points * row_size_, 0)
{}

void Accumulator::clear() { std::fill(cells_.begin(), cells_.end(), 0u); }

void Accumulator::vote(const TableEntry* entries, std::uint32_t count, std::uint16_t alpha_s, std::uint32_t weight)
{
  for (std::uint32_t i = 0; i < count; ++i)
  {
    const TableEntry entry = entries[i];
    // alpha = alpha_m - alpha_s (Equation 7), wrapped by the 16 bits of a turn.
    const auto alpha = static_cast<std::uint16_t>(entry.alpha() - alpha_s);
    const std::uint32_t bin = (static_cast<std::uint32_t>(alpha) * num_angles_) >> 16;
    cells_[entry.reference() * row_size_ + bin] += entry.weighted() ? weight : 1;  // Equation 8
  }
}

std::vector<Accumulator::Peak> Accumulator::peaks(bool sum_adjacent, double min_share) const
{
  struct RowBest
  {
    std::uint32_t votes;
    std::uint32_t bin;
  };
  std::vector<RowBest> rows(num_rows_);
  std::uint32_t highest = 0;
  for (std::size_t r = 0; r < num_rows_; ++r)
  {
    const std::uint32_t* row = &cells_[r * row_size_];
    RowBest best{0, 0};
    for (std::uint32_t a = 0; a < num_angles_; ++a)
    {
      const std::uint32_t votes = row[a] + (sum_adjacent ? row[a + 1 < num_angles_ ? a + 1 : 0] : 0);
      if (votes > best.votes)
        best = {votes, a};
    }
    rows[r] = best;
    highest = std::max(highest, best.votes);
  }
  std::vector<Peak> peaks;
  const double threshold = std::max(1.0, min_share * highest);
  const double step = 2 * M_PI / num_angles_;
  for (std::size_t r = 0; r < num_rows_; ++r)
  {
    if (rows[r].votes < threshold)
      continue;
    double bin = rows[r].bin + 0.5;
    if (sum_adjacent)
      bin += static_cast<double>(cells_[r * row_size_ + (rows[r].bin + 1) % num_angles_]) / rows[r].votes;
    peaks.push_back({static_cast<int>(r), static_cast<float>(bin * step), static_cast<double>(rows[r].votes)});
  }
  std::sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) {
    return a.votes != b.votes ? a.votes > b.votes : a.model_point < b.model_point;
  });
  return peaks;
}
}  // namespace bin_picking
