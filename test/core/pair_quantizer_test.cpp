// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "../../src/core/matching/pair_quantizer.hpp"

#include <gtest/gtest.h>

#include "analytic_surfaces.hpp"
#include "hand_made_model.hpp"

namespace bin_picking
{
namespace
{
constexpr double MIN_DISTANCE = 0.005;
constexpr double REACH = 0.09;

FeatureQuantizer quantizer()
{
  FeatureQuantizer q;
  q.distance_bins = 32;  // of 2.5 mm: shorter than the reach
  return q;
}

struct Pairs
{
  std::vector<std::uint32_t> keys;
  std::vector<std::uint16_t> alphas;
};

Pairs quantized(const OrientedPoints& points, std::size_t i, std::size_t begin)
{
  const FlatPoints flat(points, test::everyIndex(points.size()));
  Pairs pairs;
  pairs.keys.resize(points.size() - begin);
  pairs.alphas.resize(points.size() - begin);
  PairQuantizer(quantizer(), MIN_DISTANCE, REACH)
      .quantize(PairOrigin(points.points[i], points.normals[i]), flat, begin, points.size(), pairs.keys.data(),
                pairs.alphas.data());
  return pairs;
}

TEST(PairQuantizer, agreesWithTheExactFunctionsButAtTheEdgesOfBins)
{
  const OrientedPoints points = test::torus(0.04, 0.015, 701);  // an odd number: the vectors' remainder counts too
  const FeatureQuantizer q = quantizer();
  std::size_t num_pairs = 0;
  std::size_t others = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Pairs pairs = quantized(points, i, 0);
    const Eigen::Isometry3f T_local = alignToLocalFrame(points.points[i], points.normals[i]);
    for (std::size_t j = 0; j < points.size(); ++j)
    {
      const auto f = pairFeature(points.points[i], points.normals[i], 0, points.points[j], points.normals[j], 0);
      const bool near = f.distance >= MIN_DISTANCE && f.distance <= REACH;
      const std::int64_t exact = near ? q.geometricKey(f) : -1;
      ++num_pairs;
      others += pairs.keys[j] != (exact < 0 ? q.numGeometricKeys() : static_cast<std::uint32_t>(exact));
      const auto alpha = toTurnFraction(alphaInLocalFrame(T_local * points.points[j]));
      const auto difference = static_cast<std::int16_t>(pairs.alphas[j] - alpha);
      if (near)
      {
        // 0.01 degrees; float rounding adds to it where the point is close to the axis.
        const Eigen::Vector3f local = T_local * points.points[j];
        EXPECT_LE(std::abs(difference), 2 + 1e-3 / std::hypot(local.y(), local.z()));
      }
    }
  }
  // Float rounding of 1e-6 rad or 1e-8 m against bins of 0.2 rad or 2.5 mm.
  EXPECT_LT(static_cast<double>(others), 1e-4 * static_cast<double>(num_pairs));
}

TEST(PairQuantizer, sameKeysWhereverARunBegins)
{
  const OrientedPoints points = test::torus(0.04, 0.015, 100);
  const Pairs all = quantized(points, 7, 0);
  for (std::size_t begin = 1; begin < 40; ++begin)
  {
    const Pairs rest = quantized(points, 7, begin);
    EXPECT_TRUE(std::equal(rest.keys.begin(), rest.keys.end(), all.keys.begin() + static_cast<long>(begin)));
    EXPECT_TRUE(std::equal(rest.alphas.begin(), rest.alphas.end(), all.alphas.begin() + static_cast<long>(begin)));
  }
}

TEST(PairQuantizer, oppositeAndEqualNormalsHaveKeys)
{
  OrientedPoints points;
  test::add(points, {0, 0, 0}, {0, 0, 1});
  test::add(points, {0.02, 0, 0}, {0, 0, 1});
  test::add(points, {0, 0, 0.02}, {0, 0, -1});
  test::add(points, {0, 0, -0.02}, {0, 0, 1});
  const Pairs pairs = quantized(points, 0, 0);
  EXPECT_EQ(pairs.keys[0], quantizer().numGeometricKeys()) << "a point and itself are no pair";
  for (std::size_t j = 1; j < points.size(); ++j)
    EXPECT_LT(pairs.keys[j], quantizer().numGeometricKeys()) << j;
}
}  // namespace
}  // namespace bin_picking
