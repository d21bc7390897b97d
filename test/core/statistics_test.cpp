// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace bin_picking
{
namespace
{
TEST(Ratio, WilsonIntervalsAreThoseOfTheLiterature)
{
  // Newcombe 1998, Statistics in Medicine 17, Table I, method 3 (score, without continuity correction).
  const Interval common = Ratio{81, 263}.interval();
  EXPECT_NEAR(common.low, 0.2553, 5e-5);
  EXPECT_NEAR(common.high, 0.3662, 5e-5);
  const Interval rare = Ratio{15, 148}.interval();
  EXPECT_NEAR(rare.low, 0.0624, 5e-5);
  EXPECT_NEAR(rare.high, 0.1605, 5e-5);
  const Interval none = Ratio{0, 20}.interval();
  EXPECT_EQ(none.low, 0);
  EXPECT_NEAR(none.high, 0.1611, 5e-5);
  const Interval single = Ratio{1, 29}.interval();
  EXPECT_NEAR(single.low, 0.0061, 5e-5);
  EXPECT_NEAR(single.high, 0.1718, 5e-5);
}

TEST(Ratio, AllRightIsNotCertain)
{
  const Interval all = Ratio{5, 5}.interval();
  EXPECT_EQ(all.high, 1);
  EXPECT_NEAR(all.low, 1 - (Ratio{0, 5}).interval().high, 1e-12);  // hits and failures are symmetric
  EXPECT_LT(all.low, 0.6);
}

TEST(Ratio, NothingCountedSaysNothing)
{
  EXPECT_TRUE(std::isnan(Ratio().value()));
  EXPECT_EQ(Ratio().interval().low, 0);
  EXPECT_EQ(Ratio().interval().high, 1);
}

TEST(Spread, MedianAndPercentileOfKnownValues)
{
  const Spread odd = spread({3, 1, 2});
  EXPECT_DOUBLE_EQ(odd.median, 2);
  EXPECT_DOUBLE_EQ(odd.p95, 2.9);  // 1.9 steps above the lowest of three
  EXPECT_EQ(odd.count, 3);
  EXPECT_DOUBLE_EQ(spread({1, 2, 3, 10}).median, 2.5);
  EXPECT_DOUBLE_EQ(spread({7}).p95, 7);
  EXPECT_TRUE(std::isnan(spread({}).median));
  EXPECT_TRUE(std::isnan(spread({}).p95));
}

TEST(AveragePrecision, OfAHandMadeList)
{
  // By rank: right, wrong, right, right, wrong; 5 to be found.
  // recall    1/5   1/5   2/5   3/5   3/5
  // precision 1     1/2   2/3   3/4   3/5; best at this recall or above: 1, then 3/4 at 2/5 and at 3/5.
  // Area: 1/5 * 1 + 1/5 * 3/4 + 1/5 * 3/4 = 1/2.
  const std::vector<ScoredOutcome> outcomes = {{0.9, true}, {0.8, false}, {0.7, true}, {0.6, true}, {0.5, false}};
  EXPECT_NEAR(averagePrecision(outcomes, 5).value(), 0.5, 1e-12);
}

TEST(AveragePrecision, DoesNotDependOnTheOrderOfTheList)
{
  const std::vector<ScoredOutcome> outcomes = {{0.5, false}, {0.7, true}, {0.9, true}, {0.6, true}, {0.8, false}};
  EXPECT_NEAR(averagePrecision(outcomes, 5).value(), 0.5, 1e-12);
  // Equal scores: one right and one wrong enter together, precision 1/2.
  EXPECT_NEAR(averagePrecision({{0.5, true}, {0.5, false}}, 1).value(), 0.5, 1e-12);
  EXPECT_NEAR(averagePrecision({{0.5, false}, {0.5, true}}, 1).value(), 0.5, 1e-12);
}

TEST(AveragePrecision, ReachesItsBounds)
{
  EXPECT_DOUBLE_EQ(averagePrecision({{0.9, true}, {0.8, true}}, 2).value(), 1);
  EXPECT_DOUBLE_EQ(averagePrecision({{0.9, true}, {0.8, true}, {0.1, false}}, 2).value(), 1);  // wrong ones come last
  EXPECT_DOUBLE_EQ(averagePrecision({{0.9, false}, {0.8, false}}, 2).value(), 0);
  EXPECT_DOUBLE_EQ(averagePrecision({}, 2).value(), 0);
  EXPECT_DOUBLE_EQ(averagePrecision({{0.9, true}}, 4).value(), 0.25);
  EXPECT_FALSE(averagePrecision({{0.9, false}}, 0).has_value());
}
}  // namespace
}  // namespace bin_picking
