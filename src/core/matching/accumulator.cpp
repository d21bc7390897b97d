// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "accumulator.hpp"

#include <algorithm>
#include <cmath>

#include "../common/simd.hpp"

namespace bin_picking
{
namespace
{
constexpr std::uint32_t FULL = 0xffff;

/// Rows start at a power of two, a cache line or more, with room for the first column behind the last.
unsigned shiftFor(int num_angles)
{
  unsigned shift = 5;
  while (1 << shift <= num_angles)
    ++shift;
  return shift;
}

/// Highest cell of each row, of it and its next neighbour where these are summed.
BIN_PICKING_SIMD void highestOfRows(const std::uint16_t* __restrict cells, std::size_t num_rows, std::size_t row_size,
                                    std::size_t num_angles, bool sum_adjacent, std::uint16_t* __restrict highest)
{
  for (std::size_t r = 0; r < num_rows; ++r)
  {
    const std::uint16_t* row = cells + r * row_size;
    std::uint16_t best = 0;
    if (sum_adjacent)
      for (std::size_t a = 0; a < num_angles; ++a)
      {
        // Full when the sum does not fit.
        const auto sum = static_cast<std::uint16_t>(row[a] + row[a + 1]);
        const std::uint16_t votes = sum < row[a] ? static_cast<std::uint16_t>(FULL) : sum;
        best = votes > best ? votes : best;
      }
    else
      for (std::size_t a = 0; a < num_angles; ++a)
        best = row[a] > best ? row[a] : best;
    highest[r] = best;
  }
}
}  // namespace

Accumulator::Accumulator(std::size_t num_references, int num_angles)
    : num_rows_(num_references),
      num_angles_(static_cast<std::uint32_t>(num_angles)),
      row_shift_(shiftFor(num_angles)),
      cells_(num_references << row_shift_, 0),
      highest_(num_references, 0)
{}

void Accumulator::clear() { std::fill(cells_.begin(), cells_.end(), std::uint16_t{0}); }

namespace
{
template <bool EQUAL_WEIGHTS>
void addVotes(std::uint16_t* cells, unsigned row_shift, std::uint32_t num_angles, const TableEntry* begin,
              const TableEntry* end, std::uint16_t alpha_s, std::uint32_t weight)
{
  for (const TableEntry* entry = begin; entry != end; ++entry)
  {
    // alpha = alpha_m - alpha_s (Equation 7), wrapped by the 16 bits of a turn.
    const auto alpha = static_cast<std::uint16_t>(entry->alpha() - alpha_s);
    const std::uint32_t bin = (static_cast<std::uint32_t>(alpha) * num_angles) >> 16;
    std::uint16_t& cell = cells[(entry->reference() << row_shift) + bin];
    const std::uint32_t votes = cell + (EQUAL_WEIGHTS || !entry->weighted() ? 1u : weight);  // Equation 8
    cell = static_cast<std::uint16_t>(EQUAL_WEIGHTS ? votes - (votes >> 16) : std::min(votes, FULL));
  }
}
}  // namespace

void Accumulator::vote(const TableEntry* begin, const TableEntry* end, std::uint16_t alpha_s, std::uint32_t weight)
{
  const auto add = weight == 1 ? addVotes<true> : addVotes<false>;
  add(cells_.data(), row_shift_, num_angles_, begin, end, alpha_s, weight);
}

Accumulator::Peak Accumulator::peakOf(std::size_t row, bool sum_adjacent) const
{
  const std::uint16_t* cells = &cells_[row << row_shift_];
  Peak peak{static_cast<std::uint32_t>(row), 0, 0};
  std::uint32_t best = 0;
  for (std::uint32_t a = 0; a < num_angles_; ++a)
  {
    const std::uint32_t votes = cells[a] + (sum_adjacent ? cells[a + 1] : 0u);
    if (votes > peak.votes)
    {
      peak.votes = votes;
      best = a;
    }
  }
  double bin = best + 0.5;
  if (sum_adjacent && peak.votes > 0)
    bin += static_cast<double>(cells[best + 1]) / peak.votes;
  peak.alpha = static_cast<float>(bin * 2 * M_PI / num_angles_);
  return peak;
}

std::vector<Accumulator::Peak> Accumulator::peaks(bool sum_adjacent, double min_share)
{
  for (std::size_t r = 0; r < num_rows_; ++r)
    cells_[(r << row_shift_) + num_angles_] = cells_[r << row_shift_];  // what comes behind the last step is the first
  highestOfRows(cells_.data(), num_rows_, std::size_t{1} << row_shift_, num_angles_, sum_adjacent, highest_.data());
  const std::uint16_t highest = num_rows_ == 0 ? 0 : *std::max_element(highest_.begin(), highest_.end());
  const double threshold = std::max(1.0, min_share * highest);
  std::vector<Peak> peaks;
  for (std::size_t r = 0; r < num_rows_; ++r)
    if (highest_[r] >= threshold)
      peaks.push_back(peakOf(r, sum_adjacent));
  std::sort(peaks.begin(), peaks.end(),
            [](const Peak& a, const Peak& b) { return a.votes != b.votes ? a.votes > b.votes : a.row < b.row; });
  return peaks;
}
}  // namespace bin_picking
