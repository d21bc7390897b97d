// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace bin_picking
{
/// A set of numbers that also knows how many of its members are smaller than a given one: a perfect hash from the
/// members to 0 ... count - 1 that keeps their order, at a quarter of a byte per possible number.
class RankedBits
{
public:
  /// The empty set, of numbers up to `size` (which itself never becomes a member, but may be asked for).
  explicit RankedBits(std::size_t size = 0) : words_(size / BITS + 1) {}

  void insert(std::uint32_t number) { words_[number / BITS].bits |= 1u << number % BITS; }

  /// To be called after the last insert. \return the number of members
  std::uint32_t rankMembers()
  {
    std::uint32_t count = 0;
    for (Word& word : words_)
    {
      word.rank = count;
      count += static_cast<std::uint32_t>(__builtin_popcount(word.bits));
    }
    return count;
  }

  bool contains(std::uint32_t number) const { return words_[number / BITS].bits >> number % BITS & 1u; }

  /// Members that are smaller than `number`.
  std::uint32_t rank(std::uint32_t number) const
  {
    const Word& word = words_[number / BITS];
    const std::uint32_t smaller = word.bits & ((1u << number % BITS) - 1);
    return word.rank + static_cast<std::uint32_t>(__builtin_popcount(smaller));
  }

  std::size_t bytes() const { return words_.size() * sizeof(Word); }

private:
  friend struct ModelFileAccess;
  static constexpr std::uint32_t BITS = 32;

  struct Word
  {
    std::uint32_t bits = 0;  ///< which of 32 numbers are members
    std::uint32_t rank = 0;  ///< members before them
  };
  std::vector<Word> words_;
};
}  // namespace bin_picking
