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

/// highest[r] = max(highest[r], a[r] + b[r]), full where the sum does not fit.
BIN_PICKING_SIMD void raiseToSum(const std::uint16_t* __restrict a, const std::uint16_t* __restrict b,
                                 std::size_t num_rows, std::uint16_t* __restrict highest)
{
  for (std::size_t r = 0; r < num_rows; ++r)
  {
    const auto sum = static_cast<std::uint16_t>(a[r] + b[r]);
    const std::uint16_t votes = sum < a[r] ? static_cast<std::uint16_t>(FULL) : sum;
    highest[r] = votes > highest[r] ? votes : highest[r];
  }
}

/// highest[r] = max(highest[r], a[r])
BIN_PICKING_SIMD void raiseTo(const std::uint16_t* __restrict a, std::size_t num_rows,
                              std::uint16_t* __restrict highest)
{
  for (std::size_t r = 0; r < num_rows; ++r)
    highest[r] = a[r] > highest[r] ? a[r] : highest[r];
}

template <bool EQUAL_WEIGHTS>
void addVotes(std::uint16_t* cells, std::uint32_t num_rows, std::uint32_t num_angles, const TableEntry* begin,
              const TableEntry* end, std::uint16_t alpha_s, std::uint32_t weight)
{
  for (const TableEntry* entry = begin; entry != end; ++entry)
  {
    // alpha = alpha_m - alpha_s (Equation 7), wrapped by the 16 bits of a turn.
    const auto alpha = static_cast<std::uint16_t>(entry->alpha() - alpha_s);
    const std::uint32_t bin = (static_cast<std::uint32_t>(alpha) * num_angles) >> 16;
    std::uint16_t& cell = cells[bin * num_rows + entry->reference()];
    const std::uint32_t votes = cell + (EQUAL_WEIGHTS || !entry->weighted() ? 1u : weight);  // Equation 8
    cell = static_cast<std::uint16_t>(EQUAL_WEIGHTS ? votes - (votes >> 16) : std::min(votes, FULL));
  }
}
}  // namespace

Accumulator::Accumulator(std::size_t num_references, int num_angles)
    : num_rows_(static_cast<std::uint32_t>(num_references)),
      num_angles_(static_cast<std::uint32_t>(num_angles)),
      cells_(num_references * static_cast<std::size_t>(num_angles), 0),
      highest_(num_references, 0)
{}

void Accumulator::clear() { std::fill(cells_.begin(), cells_.end(), std::uint16_t{0}); }

void Accumulator::vote(const TableEntry* begin, const TableEntry* end, std::uint16_t alpha_s, std::uint32_t weight)
{
  const auto add = weight == 1 ? addVotes<true> : addVotes<false>;
  add(cells_.data(), num_rows_, num_angles_, begin, end, alpha_s, weight);
}

Accumulator::Peak Accumulator::peakOf(std::uint32_t row, bool sum_adjacent) const
{
  const auto votesAt = [&](std::uint32_t a) -> std::uint32_t { return cells_[a % num_angles_ * num_rows_ + row]; };
  Peak peak{row, 0, 0};
  std::uint32_t best = 0;
  for (std::uint32_t a = 0; a < num_angles_; ++a)
  {
    const std::uint32_t votes = votesAt(a) + (sum_adjacent ? votesAt(a + 1) : 0u);
    if (votes > peak.votes)
    {
      peak.votes = votes;
      best = a;
    }
  }
  double bin = best + 0.5;
  if (sum_adjacent && peak.votes > 0)
    bin += static_cast<double>(votesAt(best + 1)) / peak.votes;
  peak.alpha = static_cast<float>(bin * 2 * M_PI / num_angles_);
  return peak;
}

void Accumulator::findRows(bool sum_adjacent, double min_share)
{
  std::fill(highest_.begin(), highest_.end(), std::uint16_t{0});
  for (std::uint32_t a = 0; a < num_angles_; ++a)
  {
    const std::uint16_t* column = cells_.data() + std::size_t{a} * num_rows_;
    const std::uint16_t* next = cells_.data() + std::size_t{(a + 1) % num_angles_} * num_rows_;
    if (sum_adjacent)
      raiseToSum(column, next, num_rows_, highest_.data());
    else
      raiseTo(column, num_rows_, highest_.data());
  }
  const std::uint16_t highest = highest_.empty() ? 0 : *std::max_element(highest_.begin(), highest_.end());
  const double threshold = std::max(1.0, min_share * highest);
  rows_.clear();
  for (std::uint32_t r = 0; r < num_rows_; ++r)
    if (highest_[r] >= threshold)
      rows_.push_back(std::uint64_t{highest_[r]} << 32 | ~r);
  std::make_heap(rows_.begin(), rows_.end());
}
}  // namespace bin_picking
