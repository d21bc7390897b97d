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

/// highest[r] = max(highest[r], a[r] + b[r])
BIN_PICKING_SIMD void raiseToSum(const std::uint8_t* __restrict a, const std::uint8_t* __restrict b,
                                 std::size_t num_rows, std::uint16_t* __restrict highest)
{
  for (std::size_t r = 0; r < num_rows; ++r)
  {
    const auto votes = static_cast<std::uint16_t>(a[r] + b[r]);
    highest[r] = votes > highest[r] ? votes : highest[r];
  }
}

/// highest[r] = max(highest[r], a[r])
BIN_PICKING_SIMD void raise(const std::uint8_t* __restrict a, std::size_t num_rows, std::uint16_t* __restrict highest)
{
  for (std::size_t r = 0; r < num_rows; ++r)
  {
    const std::uint16_t votes = a[r];
    highest[r] = votes > highest[r] ? votes : highest[r];
  }
}

/// The same of both planes; full where the sum does not fit.
BIN_PICKING_SIMD void raiseToSum(const std::uint8_t* __restrict a_low, const std::uint8_t* __restrict a_high,
                                 const std::uint8_t* __restrict b_low, const std::uint8_t* __restrict b_high,
                                 std::size_t num_rows, std::uint16_t* __restrict highest)
{
  for (std::size_t r = 0; r < num_rows; ++r)
  {
    const auto a = static_cast<std::uint16_t>(a_high[r] << 8 | a_low[r]);
    const auto b = static_cast<std::uint16_t>(b_high[r] << 8 | b_low[r]);
    const auto sum = static_cast<std::uint16_t>(a + b);
    const std::uint16_t votes = sum < a ? static_cast<std::uint16_t>(FULL) : sum;
    highest[r] = votes > highest[r] ? votes : highest[r];
  }
}

BIN_PICKING_SIMD void raise(const std::uint8_t* __restrict low, const std::uint8_t* __restrict high,
                            std::size_t num_rows, std::uint16_t* __restrict highest)
{
  for (std::size_t r = 0; r < num_rows; ++r)
  {
    const auto votes = static_cast<std::uint16_t>(high[r] << 8 | low[r]);
    highest[r] = votes > highest[r] ? votes : highest[r];
  }
}

/// More votes than the lower plane of a cell holds.
void carry(std::uint8_t& low, std::uint8_t& high, std::uint32_t more)
{
  const std::uint32_t sum = high + more;
  high = static_cast<std::uint8_t>(std::min(sum, 0xffu));
  low = sum > 0xff ? std::uint8_t{0xff} : low;
}

/// \return whether any vote went to the upper plane
template <bool EQUAL_WEIGHTS>
bool addVotes(std::uint8_t* low, std::uint8_t* high, std::uint32_t num_rows, std::uint32_t num_angles,
              const TableEntry* begin, const TableEntry* end, std::uint16_t alpha_s, std::uint32_t weight)
{
  bool carried = false;
  for (const TableEntry* entry = begin; entry != end; ++entry)
  {
    // alpha = alpha_m - alpha_s (Equation 7), wrapped by the 16 bits of a turn.
    const auto alpha = static_cast<std::uint16_t>(entry->alpha() - alpha_s);
    const std::uint32_t bin = (static_cast<std::uint32_t>(alpha) * num_angles) >> 16;
    const std::size_t cell = std::size_t{bin} * num_rows + entry->reference();
    const std::uint32_t votes = low[cell] + (EQUAL_WEIGHTS || !entry->weighted() ? 1u : weight);  // Equation 8
    low[cell] = static_cast<std::uint8_t>(votes);
    if (votes > 0xff)
    {
      carry(low[cell], high[cell], votes >> 8);
      carried = true;
    }
  }
  return carried;
}
}  // namespace

Accumulator::Accumulator(std::size_t num_references, int num_angles)
    : num_rows_(static_cast<std::uint32_t>(num_references)),
      num_angles_(static_cast<std::uint32_t>(num_angles)),
      low_(num_references * static_cast<std::size_t>(num_angles), 0),
      high_(low_.size(), 0),
      highest_(num_references, 0)
{}

void Accumulator::clear()
{
  std::fill(low_.begin(), low_.end(), std::uint8_t{0});
  if (carried_)
    std::fill(high_.begin(), high_.end(), std::uint8_t{0});
  carried_ = false;
}

void Accumulator::vote(const TableEntry* begin, const TableEntry* end, std::uint16_t alpha_s, std::uint32_t weight)
{
  const auto add = weight == 1 ? addVotes<true> : addVotes<false>;
  carried_ = add(low_.data(), high_.data(), num_rows_, num_angles_, begin, end, alpha_s, weight) || carried_;
}

std::uint32_t Accumulator::votesAt(std::uint32_t row, std::uint32_t column) const
{
  const std::size_t cell = std::size_t{column % num_angles_} * num_rows_ + row;
  return static_cast<std::uint32_t>(high_[cell]) << 8 | low_[cell];
}

Accumulator::Peak Accumulator::peakOf(std::uint32_t row, bool sum_adjacent) const
{
  Peak peak{row, 0, 0};
  std::uint32_t best = 0;
  for (std::uint32_t a = 0; a < num_angles_; ++a)
  {
    const std::uint32_t votes = votesAt(row, a) + (sum_adjacent ? votesAt(row, a + 1) : 0u);
    if (votes > peak.votes)
    {
      peak.votes = votes;
      best = a;
    }
  }
  double bin = best + 0.5;
  if (sum_adjacent && peak.votes > 0)
    bin += static_cast<double>(votesAt(row, best + 1)) / peak.votes;
  peak.alpha = static_cast<float>(bin * 2 * M_PI / num_angles_);
  return peak;
}

void Accumulator::raiseToColumn(std::uint32_t column, bool sum_adjacent)
{
  const std::size_t at = std::size_t{column} * num_rows_;
  const std::size_t next = std::size_t{(column + 1) % num_angles_} * num_rows_;
  if (carried_ && sum_adjacent)
    raiseToSum(&low_[at], &high_[at], &low_[next], &high_[next], num_rows_, highest_.data());
  else if (carried_)
    raise(&low_[at], &high_[at], num_rows_, highest_.data());
  else if (sum_adjacent)
    raiseToSum(&low_[at], &low_[next], num_rows_, highest_.data());
  else
    raise(&low_[at], num_rows_, highest_.data());
}

void Accumulator::findRows(bool sum_adjacent, double min_share)
{
  std::fill(highest_.begin(), highest_.end(), std::uint16_t{0});
  for (std::uint32_t a = 0; a < num_angles_; ++a)
    raiseToColumn(a, sum_adjacent);
  const std::uint16_t highest = highest_.empty() ? 0 : *std::max_element(highest_.begin(), highest_.end());
  const double threshold = std::max(1.0, min_share * highest);
  rows_.clear();
  for (std::uint32_t r = 0; r < num_rows_; ++r)
    if (highest_[r] >= threshold)
      rows_.push_back(std::uint64_t{highest_[r]} << 32 | ~r);
  std::make_heap(rows_.begin(), rows_.end());
}
}  // namespace bin_picking
