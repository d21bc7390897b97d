// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// Piles in the bin: at rest, inside, hardly into each other, and the same for the same seed.
#include <gtest/gtest.h>

#include <set>

#include "bin_picking_perception/common/error.hpp"
#include "core/bin_piles.hpp"
#include "core/mesh_shapes.hpp"
#include "core/temporary_folder.hpp"

using namespace bin_picking;
using namespace bin_picking::test;

namespace
{
/// The farthest that the middle of any of the `before` has moved.
double moved(const std::vector<Body>& before, const std::vector<Body>& after, int except)
{
  double farthest = 0;
  for (const Body& body : before)
    if (body.id != except)
      farthest = std::max(farthest,
                          (find(after, body.id)->T_bin_object.translation() - body.T_bin_object.translation()).norm());
  return farthest;
}

double middleHeight(const Body& body, const Kind& kind) { return (body.T_bin_object * kind.shape->center_of_mass).z(); }
}  // namespace

TEST(BinPhysics, droppedBlockLiesFlatOnAFace)
{
  const Kind block(box(0.06f, 0.04f, 0.025f));
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u})
  {
    BinPhysics physics = binOf({&block});
    physics.drop({0}, seed);
    std::vector<double> heights;
    const Body body = physics.bodies().at(0);
    for (const Eigen::Vector3f& vertex : block.mesh->vertices)
      heights.push_back((body.T_bin_object * vertex.cast<double>()).z());
    std::sort(heights.begin(), heights.end());
    // Contacts are computed with rounded bodies: half of MAX_DEPTH is what they are off.
    for (int k = 0; k < 4; ++k)
      EXPECT_NEAR(heights[static_cast<std::size_t>(k)], 0, MAX_DEPTH / 2) << seed;
    const double height = heights.back();
    EXPECT_LT(std::min({std::abs(height - 0.06), std::abs(height - 0.04), std::abs(height - 0.025)}), MAX_DEPTH / 2);
  }
}

TEST(BinPhysics, pilesAreInTheBinAndPartsHardlyInEachOther)
{
  for (const std::uint32_t seed : {1u, 2u, 3u})
  {
    SCOPED_TRACE(seed);
    const BinPhysics physics = pileOfTees(12, seed);
    EXPECT_EQ(physics.bodies().size(), 12u);
    expectSound(physics.bodies(), {&tee()});
  }
}

TEST(BinPhysics, mixedPileIsSoundToo)
{
  const std::vector<const Kind*> kinds = {&tee(), &demoPart("hex_bolt"), &demoPart("l_bracket")};
  BinPhysics physics = binOf(kinds);
  physics.drop({0, 1, 2, 1, 0, 2, 1, 1, 2, 0, 2, 0}, 5);
  const std::vector<Body> bodies = physics.bodies();
  ASSERT_EQ(bodies.size(), 12u);
  EXPECT_EQ(bodies[2].shape, 2) << "in the order of dropping";
  expectSound(bodies, kinds);
}

TEST(BinPhysics, partsPileUp)
{
  const std::vector<Body> bodies = pileOfTees(12, 1, {0.2, 0.15, 0.2}).bodies();
  double highest = 0;
  for (const Body& body : bodies)
    highest = std::max(highest, middleHeight(body, tee()));
  EXPECT_GT(highest, 0.05) << "a tee alone has its middle below 0.04 m";
  expectSound(bodies, {&tee()}, {0.2, 0.15, 0.2});
}

TEST(BinPhysics, whatRestsKeepsRestingWhenAPartFarAwayGoes)
{
  BinPhysics physics = pileOfTees(8, 2, {1.5, 1.2, 0.15});
  const std::vector<Body> before = physics.bodies();
  const Body lone = *std::max_element(before.begin(), before.end(), [](const Body& a, const Body& b) {
    return a.T_bin_object.translation().norm() < b.T_bin_object.translation().norm();
  });
  for (const Body& body : before)
  {
    const double distance = (body.T_bin_object.translation() - lone.T_bin_object.translation()).norm();
    ASSERT_TRUE(body.id == lone.id || distance > 2 * tee().shape->radius) << "the lone part is not alone";
  }
  ASSERT_TRUE(physics.remove(lone.id));
  // At rest is what moves less than 1 mm in the time that is looked at, so it must not be more than that now.
  EXPECT_LT(moved(before, physics.bodies(), lone.id), 0.001);
}

TEST(BinPhysics, seedDecidesEveryBit)
{
  const std::vector<Body> first = pileOfTees(8, 7).bodies();
  EXPECT_TRUE(same(first, pileOfTees(8, 7).bodies()));
  EXPECT_FALSE(same(first, pileOfTees(8, 8).bodies()));
}

TEST(BinPhysics, clearedBinIsAsNew)
{
  BinPhysics physics = pileOfTees(10, 3);
  std::set<int> ids;
  for (const Body& body : physics.bodies())
    ids.insert(body.id);
  physics.remove(*ids.begin());
  physics.clear();
  EXPECT_TRUE(physics.bodies().empty());
  physics.drop(std::vector<int>(8, 0), 7);
  EXPECT_TRUE(same(physics.bodies(), pileOfTees(8, 7).bodies()));
  for (const Body& body : physics.bodies())
    EXPECT_TRUE(ids.insert(body.id).second) << "an id is never used twice: " << body.id;
}

TEST(BinPhysics, removingTakesOnePartAndLetsTheOthersFollow)
{
  BinPhysics physics = pileOfTees(10, 4, {0.2, 0.15, 0.2});
  const std::vector<Body> before = physics.bodies();
  EXPECT_FALSE(physics.remove(12345));
  EXPECT_TRUE(same(before, physics.bodies()));
  const Body lowest = *std::min_element(before.begin(), before.end(), [](const Body& a, const Body& b) {
    return middleHeight(a, tee()) < middleHeight(b, tee());
  });
  ASSERT_TRUE(physics.remove(lowest.id));
  EXPECT_EQ(physics.bodies().size(), 9u);
  EXPECT_EQ(find(physics.bodies(), lowest.id), nullptr);
  EXPECT_FALSE(physics.remove(lowest.id));
  EXPECT_GT(moved(before, physics.bodies(), lowest.id), 0.005) << "what lay on it comes down";
  expectSound(physics.bodies(), {&tee()}, {0.2, 0.15, 0.2});
}

TEST(BinPhysics, droppingAgainMovesThePartAndKeepsAll)
{
  BinPhysics physics = pileOfTees(6, 5);
  const std::vector<Body> before = physics.bodies();
  EXPECT_FALSE(physics.dropAgain(12345, 1));
  EXPECT_TRUE(same(before, physics.bodies()));
  ASSERT_TRUE(physics.dropAgain(before[2].id, 1));
  const std::vector<Body> after = physics.bodies();
  ASSERT_EQ(after.size(), 6u);
  EXPECT_GT((after[2].T_bin_object.translation() - before[2].T_bin_object.translation()).norm(), 0.01);
  EXPECT_EQ(after[2].id, before[2].id);
  expectSound(after, {&tee()});
  BinPhysics twin = pileOfTees(6, 5);
  twin.dropAgain(twin.bodies()[2].id, 1);
  EXPECT_TRUE(same(after, twin.bodies()));
}

TEST(BinPhysics, morePartsFallOnThoseThatLieThere)
{
  BinPhysics physics = pileOfTees(5, 6);
  physics.drop({0, 0, 0}, 1);
  EXPECT_EQ(physics.bodies().size(), 8u);
  expectSound(physics.bodies(), {&tee()});
  const std::vector<Body> before = physics.bodies();
  physics.drop({}, 1);
  EXPECT_EQ(physics.bodies().size(), 8u);
  EXPECT_LT(moved(before, physics.bodies(), 0), 0.001) << "nothing was dropped on what rests";
}

TEST(BinPhysics, partLargerThanTheBinIsRefused)
{
  expectWords(messageOf<ParameterError>([] {
                binOf({&tee()}, {0.06, 0.06, 0.1});
              }),
              {"too large for the bin", "52 mm", "60 mm x 60 mm"});
}

TEST(BinPhysics, parametersOutOfRangeAreRefused)
{
  PhysicsParameters parameters;
  parameters.time_step = 0.1;
  expectWords(messageOf<ParameterError>([&] { BinPhysics({tee().shape}, BIN, parameters); }), {"time_step", "0.01"});
}

TEST(BinPhysics, overfullBinIsRefusedAndCanBeUsedAfterwards)
{
  const Kind block(box(0.06f, 0.04f, 0.025f));
  const Eigen::Vector3d flat(0.15, 0.12, 0.03);
  BinPhysics physics = binOf({&block}, flat);
  expectWords(messageOf<ParameterError>([&] { physics.drop(std::vector<int>(60, 0), 1); }),
              {"the bin is too full", "60 parts", "larger bin"});
  EXPECT_EQ(physics.bodies().size(), 60u) << "what was dropped stays";
  physics.clear();
  physics.drop({0, 0}, 1);
  BinPhysics fresh = binOf({&block}, flat);
  fresh.drop({0, 0}, 1);
  EXPECT_TRUE(same(physics.bodies(), fresh.bodies()));
  expectSound(physics.bodies(), {&block}, flat);
}

TEST(BinPhysics, progressRisesToOneAndMayEndTheDrop)
{
  BinPhysics physics = binOf({&tee()});
  std::vector<double> shares;
  physics.drop({0, 0, 0}, 1, [&](double share) { shares.push_back(share); });
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.size(), 4u);
  EXPECT_EQ(shares.back(), 1);
  const auto stop = [](double) { throw std::runtime_error("stop"); };
  EXPECT_THROW(physics.drop({0, 0}, 2, stop), std::runtime_error);
  physics.drop({0}, 3);
  EXPECT_EQ(physics.bodies().size(), 5u);
  expectSound(physics.bodies(), {&tee()});
}

TEST(BinPhysics, binIsEmptiedToTheLastPart)
{
  BinPhysics physics = pileOfTees(25, 1);
  for (std::size_t left = 25; left > 0; --left)
  {
    const std::vector<Body> bodies = physics.bodies();
    ASSERT_EQ(bodies.size(), left);
    for (const Body& body : bodies)
      ASSERT_LE(behindWalls(body, *tee().mesh, BIN), MAX_DEPTH) << "of those left: " << left;
    ASSERT_LE(deepest(bodies, {&tee()}), MAX_DEPTH);
    const Body top = *std::max_element(bodies.begin(), bodies.end(), [](const Body& a, const Body& b) {
      return middleHeight(a, tee()) < middleHeight(b, tee());
    });
    ASSERT_TRUE(physics.remove(top.id));
  }
  EXPECT_TRUE(physics.bodies().empty());
}
