// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "../../src/core/matching/fast_quantizer.hpp"

#include <gtest/gtest.h>

#include "analytic_surfaces.hpp"

namespace bin_picking
{
namespace
{
TEST(FastQuantizer, agreesWithEquationFiveButOnTheSteps)
{
  FeatureQuantizer quantizer;
  quantizer.distance_step = 0.0025;
  quantizer.distance_bins = 40;
  for (const double degrees : {4.0, 12.0, 30.0})
  {
    quantizer.angle_step = degrees * M_PI / 180;
    quantizer.angle_bins = static_cast<int>(std::ceil(M_PI / quantizer.angle_step - 1e-6));
    const FastQuantizer fast(quantizer);
    std::mt19937 random(2);
    int different = 0;
    constexpr int COUNT = 100000;
    for (int i = 0; i < COUNT; ++i)
    {
      const Eigen::Vector3f p1 = (0.05 * test::unitVector(random)).cast<float>();
      const Eigen::Vector3f p2 = (0.05 * test::unitVector(random)).cast<float>();
      const Eigen::Vector3f n1 = test::unitVector(random).cast<float>();
      const Eigen::Vector3f n2 = test::unitVector(random).cast<float>();
      const Eigen::Vector3f d = p2 - p1;
      const float distance = d.norm();
      const auto exact = quantizer.geometricKey(pairFeature(p1, n1, 0, p2, n2, 0));
      different += exact != fast.geometricKey(distance, n1.dot(d) / distance, n2.dot(d) / distance, n1.dot(n2));
    }
    // Float cosines near a step of the angle: a relative width of 1e-6 on each of three angles.
    EXPECT_LT(different, COUNT / 5000) << degrees << " degrees";
  }
}

TEST(FastQuantizer, endsOfTheRange)
{
  FeatureQuantizer quantizer;
  quantizer.distance_step = 0.0025;
  quantizer.distance_bins = 40;
  const FastQuantizer fast(quantizer);
  EXPECT_EQ(fast.geometricKey(0.1001f, 0, 0, 0), -1);
  EXPECT_EQ(fast.geometricKey(0.0f, 1.0001f, 1, 1), 0);
  EXPECT_EQ(fast.geometricKey(0.0f, -1.0001f, -1, -1), 15 * 15 * 15 - 1);
}

TEST(TurnFraction, agreesWithAtan2)
{
  std::mt19937 random(4);
  for (int i = 0; i < 100000; ++i)
  {
    const auto x = static_cast<float>(test::uniform(random, -1, 1));
    const auto y = static_cast<float>(test::uniform(random, -1, 1));
    const auto difference = static_cast<std::int16_t>(turnFraction(y, x) - toTurnFraction(std::atan2(y, x)));
    EXPECT_LE(std::abs(difference), 2);  // two steps of 65536 a turn: 0.011 degrees
  }
  EXPECT_EQ(turnFraction(0, 1), 0);
  EXPECT_EQ(turnFraction(1, 0), 16384);
  EXPECT_EQ(turnFraction(0, -1), 32768);
  EXPECT_EQ(turnFraction(-1, 0), 49152);
}
}  // namespace
}  // namespace bin_picking
