// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/feature_table.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <set>

#include "analytic_surfaces.hpp"
#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/curvature_classes.hpp"

namespace bin_picking
{
namespace
{
OrientedPoints cloudWithCurvature(std::size_t count)
{
  OrientedPoints points = test::torus(0.04, 0.015, count);
  for (const auto& p : points.points)
    points.curvature.push_back(100 * p.x() / 0.055f);
  return points;
}

FeatureQuantizer quantizerFor(double step, int curvature_bins)
{
  FeatureQuantizer q;
  q.distance_step = step;
  q.distance_bins = static_cast<int>(0.12 / step);
  q.curvature_bins = curvature_bins;
  q.curvature_min = -100;
  q.curvature_step = 200.0 / curvature_bins;
  return q;
}

TEST(PairFeature, equationFiveByHand)
{
  const Eigen::Vector3f p1(0, 0, 0), p2(0.03f, 0, 0.04f), n1(0, 0, 1), n2(1, 0, 0);
  const PairFeature f = pairFeature(p1, n1, 5, p2, n2, -7);
  EXPECT_NEAR(f.distance, 0.05, 1e-7);
  EXPECT_NEAR(f.angle_n1_d, std::acos(0.8), 1e-6);
  EXPECT_NEAR(f.angle_n2_d, std::acos(0.6), 1e-6);
  EXPECT_NEAR(f.angle_n1_n2, M_PI / 2, 1e-6);
  EXPECT_EQ(f.q1, 5);
  EXPECT_EQ(f.q2, -7);
}

TEST(PairFeature, isAsymmetricAndInvariant)
{
  std::mt19937 random(7);
  const OrientedPoints points = test::torus(0.04, 0.015, 40);
  const OrientedPoints moved = transformed(points, test::randomPose(random, 0.3));
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
  {
    const auto f = pairFeature(points.points[i], points.normals[i], 1, points.points[i + 1], points.normals[i + 1], 2);
    const auto g = pairFeature(moved.points[i], moved.normals[i], 1, moved.points[i + 1], moved.normals[i + 1], 2);
    const auto back =
        pairFeature(points.points[i + 1], points.normals[i + 1], 2, points.points[i], points.normals[i], 1);
    EXPECT_NEAR(f.distance, g.distance, 1e-6);
    EXPECT_NEAR(f.angle_n1_d, g.angle_n1_d, 1e-4);
    EXPECT_NEAR(f.angle_n2_d, g.angle_n2_d, 1e-4);
    EXPECT_NEAR(f.angle_n1_n2, g.angle_n1_n2, 1e-4);
    EXPECT_NEAR(back.angle_n1_d, M_PI - f.angle_n2_d, 1e-4);  // the direction turns round
    EXPECT_EQ(back.q1, 2);
  }
}

TEST(PairFeature, localFramePutsNormalOnXAndSecondPointOnTheHalfPlane)
{
  std::mt19937 random(9);
  for (int i = 0; i < 200; ++i)
  {
    const Eigen::Vector3f p = (0.2 * test::unitVector(random)).cast<float>();
    const Eigen::Vector3f q = (0.2 * test::unitVector(random)).cast<float>();
    Eigen::Vector3f n = test::unitVector(random).cast<float>();
    if (i == 0)
      n = Eigen::Vector3f::UnitX();
    if (i == 1)
      n = -Eigen::Vector3f::UnitX();
    const Eigen::Isometry3f T = alignToLocalFrame(p, n);
    EXPECT_LT((T * p).norm(), 1e-6f);
    EXPECT_LT((T.linear() * n - Eigen::Vector3f::UnitX()).norm(), 1e-5f);
    EXPECT_NEAR(T.linear().determinant(), 1, 1e-5);
    const Eigen::Vector3f t = Eigen::AngleAxisf(alphaInLocalFrame(T * q), Eigen::Vector3f::UnitX()) * (T * q);
    EXPECT_NEAR(t.z(), 0, 1e-6);
    EXPECT_GE(t.y(), 0);
  }
}

TEST(FeatureTable, holdsExactlyThePairsOfBruteForce)
{
  const OrientedPoints points = cloudWithCurvature(150);
  for (const int curvature_bins : {1, 5})
  {
    const FeatureQuantizer q = quantizerFor(0.003, curvature_bins);
    std::vector<std::int8_t> classes(points.size());
    for (std::size_t i = 0; i < classes.size(); ++i)
      classes[i] = static_cast<std::int8_t>(i % 3 - 1);
    PairSelection selection;
    selection.min_distance = 0.005;
    const FeatureTable table(points, classes, selection, q, Executor(2));

    using Feature = std::array<int, 3>;  // geometric key and both curvature bins
    std::map<Feature, std::multiset<std::uint32_t>> expected;
    std::size_t num_pairs = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t j = 0; j < points.size(); ++j)
      {
        const auto f = pairFeature(points.points[i], points.normals[i], points.curvature[i], points.points[j],
                                   points.normals[j], points.curvature[j]);
        if (i == j || f.distance < 0.005f || q.geometricKey(f) < 0)
          continue;
        const float alpha =
            alphaInLocalFrame(alignToLocalFrame(points.points[i], points.normals[i]) * points.points[j]);
        expected[{static_cast<int>(q.geometricKey(f)), q.curvatureBin(f.q1), q.curvatureBin(f.q2)}].insert(
            TableEntry::make(static_cast<std::uint32_t>(i), classes[i] * classes[j] == -1, toTurnFraction(alpha)).bits);
        ++num_pairs;
      }
    EXPECT_EQ(table.numEntries(), num_pairs);
    EXPECT_EQ(table.numKeys(), expected.size());
    const auto find = [&table](const Feature& f) { return table.find(static_cast<std::uint32_t>(f[0]), f[1], f[2]); };
    for (const auto& [feature, entries] : expected)
    {
      const auto run = find(feature);
      std::multiset<std::uint32_t> found;
      for (std::uint32_t i = run.begin; i < run.end; ++i)
        found.insert(table.entries()[i].bits);
      EXPECT_EQ(found, entries);
      const Feature next = {feature[0] + 1, feature[1], feature[2]};
      EXPECT_EQ(find(next).size() > 0, expected.count(next) > 0);
    }
    EXPECT_FALSE(table.hasCell(q.numGeometricKeys()));
  }
}

TEST(FeatureTable, ofEdgesHoldsThePairsThatSomeViewShows)
{
  const OrientedPoints points = cloudWithCurvature(90);
  OrientedPoints edges = test::torus(0.05, 0.01, 40);
  const FeatureQuantizer q = quantizerFor(0.003, 1);
  PairSelection selection;
  selection.min_distance = 0.005;
  selection.references = {0, 7, 20, 89};
  selection.visibility_words = 1;
  for (std::size_t i = 0; i < points.size(); ++i)
    selection.visibility.push_back(std::uint64_t{1} << (i % 3));
  for (std::size_t j = 0; j < edges.size(); ++j)
    selection.second_visibility.push_back(j % 2 == 0 ? 1 : 6);
  const FeatureTable table(points, edges, selection, q, Executor(2));
  EXPECT_EQ(table.references(), selection.references);

  std::size_t expected = 0;
  for (std::uint32_t row = 0; row < 4; ++row)
    for (std::size_t j = 0; j < edges.size(); ++j)
    {
      const std::size_t i = selection.references[row];
      const PairFeature f = pairFeature(points.points[i], points.normals[i], 0, edges.points[j], edges.normals[j], 0);
      const bool is_shown = (i % 3 == 0) == (j % 2 == 0);
      if (!is_shown || f.distance < 0.005f || q.geometricKey(f) < 0)
        continue;
      ++expected;
      const float alpha = alphaInLocalFrame(alignToLocalFrame(points.points[i], points.normals[i]) * edges.points[j]);
      const auto run = table.find(static_cast<std::uint32_t>(q.geometricKey(f)), 0, 0);
      const std::uint32_t bits = TableEntry::make(row, true, toTurnFraction(alpha)).bits;
      EXPECT_TRUE(std::any_of(table.entries() + run.begin, table.entries() + run.end,
                              [bits](const TableEntry& entry) { return entry.bits == bits; }))
          << "row " << row << ", edge " << j;
    }
  EXPECT_GT(expected, 50u);
  EXPECT_EQ(table.numEntries(), expected);
}

TEST(FeatureTable, curvaturesOfOneCellAreOneRun)
{
  const OrientedPoints points = cloudWithCurvature(150);
  const std::vector<std::int8_t> none(points.size(), 0);
  const FeatureTable with(points, none, {}, quantizerFor(0.003, 5), Executor(1));
  const FeatureTable without(points, none, {}, quantizerFor(0.003, 1), Executor(1));
  for (std::uint32_t key = 0; key < without.quantizer().numGeometricKeys(); ++key)
  {
    ASSERT_EQ(with.hasCell(key), without.hasCell(key));
    if (!with.hasCell(key))
      continue;
    const std::uint32_t first = with.quantizer().key(with.cell(key), 0, 0);
    EXPECT_EQ(with.run(with.rank(first), with.rank(first + 25)).size(), without.find(key, 0, 0).size());
  }
}

TEST(FeatureTable, onlyTheGivenPointsAreReferences)
{
  const OrientedPoints points = cloudWithCurvature(60);
  const std::vector<std::int8_t> none(points.size(), 0);
  PairSelection selection;
  selection.references = {3, 14, 59};
  const FeatureTable table(points, none, selection, quantizerFor(0.003, 1), Executor(1));
  EXPECT_EQ(table.numEntries(), 3u * 59u);
  EXPECT_EQ(table.references(), selection.references);
  for (std::size_t i = 0; i < table.numEntries(); ++i)
    EXPECT_LT(table.entries()[i].reference(), 3u);
}

TEST(FeatureTable, storesOnlyPairsThatOneViewSees)
{
  const OrientedPoints points = cloudWithCurvature(60);
  std::vector<std::uint64_t> visibility(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    visibility[i] = i % 2 ? 1u : 2u;
  const FeatureQuantizer q = quantizerFor(0.003, 1);
  const std::vector<std::int8_t> none(points.size(), 0);
  PairSelection seen_together;
  seen_together.visibility = visibility;
  seen_together.visibility_words = 1;
  const FeatureTable all(points, none, {}, q, Executor(1));
  const FeatureTable half(points, none, seen_together, q, Executor(1));
  EXPECT_EQ(all.numEntries(), 60u * 59u);
  EXPECT_EQ(half.numEntries(), 2u * 30u * 29u);
}

TEST(FeatureTable, entryKeepsItsThreeFieldsApart)
{
  const auto entry = TableEntry::make(32767, true, 65535);
  EXPECT_EQ(entry.reference(), 32767u);
  EXPECT_TRUE(entry.weighted());
  EXPECT_EQ(entry.alpha(), 65535);
  EXPECT_FALSE(TableEntry::make(5, false, 1).weighted());
}

TEST(FeatureTable, refusesWhatDoesNotFit)
{
  OrientedPoints many = test::sphere(0.1, FeatureTable::MAX_REFERENCES + 1);
  const std::vector<std::int8_t> classes(many.size(), 0);
  EXPECT_THROW(FeatureTable(many, classes, {}, quantizerFor(0.003, 1), Executor(1)), ParameterError);
  const OrientedPoints few = cloudWithCurvature(10);
  EXPECT_THROW(FeatureTable(few, std::vector<std::int8_t>(10, 0), {}, quantizerFor(1e-5, 64), Executor(1)),
               ParameterError);
}

TEST(RankedBits, agreeWithASortedSet)
{
  std::mt19937 random(3);
  for (const std::uint32_t size : {1u, 31u, 32u, 1000u})
  {
    RankedBits bits(size);
    std::set<std::uint32_t> members;
    for (std::uint32_t i = 0; i < size / 3 + 1; ++i)
      members.insert(static_cast<std::uint32_t>(random()) % size);
    for (const std::uint32_t member : members)
      bits.insert(member);
    EXPECT_EQ(bits.rankMembers(), members.size());
    for (std::uint32_t i = 0; i <= size; ++i)
    {
      EXPECT_EQ(bits.contains(i), members.count(i) > 0);
      EXPECT_EQ(bits.rank(i), std::distance(members.begin(), members.lower_bound(i)));
    }
  }
}

TEST(FeatureQuantizer, clampsAnglesAndCurvatureButNotDistance)
{
  const FeatureQuantizer q = quantizerFor(0.003, 4);
  PairFeature f{0.01f, static_cast<float>(M_PI), 0, 0, 0, 0};
  EXPECT_GE(q.geometricKey(f), 0);
  f.distance = 0.2f;
  EXPECT_EQ(q.geometricKey(f), -1);
  EXPECT_EQ(q.curvatureBin(-1e6f), 0);
  EXPECT_EQ(q.curvatureBin(1e6f), 3);
  EXPECT_EQ(q.curvatureBin(0.001f), 2);
}

TEST(CurvatureClasses, splitThreeHeapsOfAHistogram)
{
  std::vector<float> curvature;
  for (int i = 0; i < 300; ++i)
  {
    curvature.push_back(1 + 0.01f * static_cast<float>(i % 7));
    curvature.push_back(-20 - 0.01f * static_cast<float>(i % 5));
    curvature.push_back(60 + 0.01f * static_cast<float>(i % 3));
  }
  curvature.push_back(NAN);
  const CurvatureClasses classes = classesFromHistogram(curvature);
  EXPECT_EQ(classes.classOf(1), -1);
  EXPECT_EQ(classes.classOf(-20), 0);
  EXPECT_EQ(classes.classOf(60), 1);
  EXPECT_EQ(classes.classOf(NAN), 0);
}

TEST(CurvatureClasses, uniformCurvatureWeighsNothing)
{
  const CurvatureClasses classes = classesFromHistogram(std::vector<float>(100, 0.f));
  EXPECT_EQ(classes.classOf(0.f), 0);
}

TEST(CurvatureBins, asManyAsMeasurementsTellApart)
{
  EXPECT_EQ(distinguishableBins(100, 8), 3);  // 100 / (4 * 8) = 3.1
  EXPECT_EQ(distinguishableBins(100, 9), 2);
  EXPECT_EQ(distinguishableBins(100, 1), MAX_AUTOMATIC_CURVATURE_BINS);
  EXPECT_EQ(distinguishableBins(1, 8), 1);
  EXPECT_EQ(distinguishableBins(100, 0), MAX_AUTOMATIC_CURVATURE_BINS) << "not known";
}

TEST(CurvatureBins, oneBinWhereCurvatureDoesNotVary)
{
  FeatureQuantizer q;
  chooseCurvatureBins(q, std::vector<float>(100, 33.3f), 0, 100);
  EXPECT_EQ(q.curvature_bins, 1);
  std::vector<float> spread;
  for (int i = 0; i <= 1000; ++i)
    spread.push_back(static_cast<float>(i - 500) / 10);
  chooseCurvatureBins(q, spread, 0, 100);
  EXPECT_EQ(q.curvature_bins, MAX_AUTOMATIC_CURVATURE_BINS);
  chooseCurvatureBins(q, spread, 25, 100);
  EXPECT_EQ(q.curvature_bins, 4);
  EXPECT_EQ(q.curvature_min, -50);
}
}  // namespace
}  // namespace bin_picking
