// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "../../src/core/matching/accumulator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

namespace bin_picking
{
namespace
{
constexpr std::size_t ROWS = 37;
constexpr int ANGLES = 30;
constexpr std::uint32_t FULL = 65535;

/// Votes counted plainly, by row and step of alpha.
class Counted
{
public:
  void vote(const std::vector<TableEntry>& entries, std::uint16_t alpha_s, std::uint32_t weight)
  {
    for (const TableEntry& entry : entries)
    {
      const auto alpha = static_cast<std::uint16_t>(entry.alpha() - alpha_s);
      std::uint32_t& votes = cells_[entry.reference()][static_cast<int>(alpha * double{ANGLES} / 65536)];
      votes = std::min(FULL, votes + (entry.weighted() ? weight : 1u));
    }
  }

  std::uint32_t at(std::uint32_t row, int angle) { return cells_[row][angle % ANGLES]; }

  std::uint32_t highest(std::uint32_t row, bool sum_adjacent)
  {
    std::uint32_t most = 0;
    for (int a = 0; a < ANGLES; ++a)
      most = std::max(most, at(row, a) + (sum_adjacent ? at(row, a + 1) : 0u));
    return most;
  }

private:
  std::map<std::uint32_t, std::map<int, std::uint32_t>> cells_;
};

void expectPeaksOf(Counted& counted, Accumulator& accumulator, bool sum_adjacent)
{
  std::size_t visited = 0;
  std::uint32_t last = 2 * FULL;
  accumulator.forEachPeak(sum_adjacent, 0, [&](const Accumulator::Peak& peak) {
    EXPECT_EQ(peak.votes, counted.highest(peak.row, sum_adjacent)) << "row " << peak.row;
    EXPECT_LE(std::min(peak.votes, FULL), last) << "strongest first";
    last = std::min(peak.votes, FULL);
    ++visited;
    return true;
  });
  std::size_t with_votes = 0;
  for (std::uint32_t row = 0; row < ROWS; ++row)
    with_votes += counted.highest(row, sum_adjacent) > 0;
  EXPECT_EQ(visited, with_votes);
}

/// Some rows get far more than others.
std::vector<TableEntry> randomEntries(std::size_t count, std::mt19937& random)
{
  std::vector<TableEntry> entries;
  for (std::size_t i = 0; i < count; ++i)
  {
    const auto row = static_cast<std::uint32_t>(std::pow(random() / 4294967296.0, 6) * ROWS);
    entries.push_back(TableEntry::make(row, random() % 4 == 0, static_cast<std::uint16_t>(random() % 20000)));
  }
  return entries;
}

TEST(Accumulator, countsFewVotesAndManyAlike)
{
  std::mt19937 random(1);
  for (const std::uint32_t weight : {1u, 3u, 64u})
  {
    Accumulator accumulator(ROWS, ANGLES);
    for (const std::size_t count : {100u, 3000u, 200000u, 50u})  // a byte holds few of these, and 16 bits most
    {
      accumulator.clear();
      Counted counted;
      for (int k = 0; k < 3; ++k)
      {
        const std::vector<TableEntry> entries = randomEntries(count, random);
        const auto alpha_s = static_cast<std::uint16_t>(random());
        accumulator.vote(entries.data(), entries.data() + entries.size(), alpha_s, weight);
        counted.vote(entries, alpha_s, weight);
      }
      for (const bool sum_adjacent : {false, true})
        expectPeaksOf(counted, accumulator, sum_adjacent);
    }
  }
}

TEST(Accumulator, aCellThatIsFullStaysFull)
{
  for (const std::uint32_t weight : {1u, 64u})
  {
    Accumulator accumulator(ROWS, ANGLES);
    const std::vector<TableEntry> entries(70000, TableEntry::make(5, true, 0));
    accumulator.vote(entries.data(), entries.data() + entries.size(), 0, weight);
    accumulator.vote(entries.data(), entries.data() + 300, 0, weight);
    accumulator.forEachPeak(false, 0, [&](const Accumulator::Peak& peak) {
      EXPECT_EQ(peak.row, 5u);
      EXPECT_EQ(peak.votes, FULL);
      return true;
    });
  }
}
}  // namespace
}  // namespace bin_picking
