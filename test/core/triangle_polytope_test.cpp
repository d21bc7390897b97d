// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// Triangles against convex bodies: held against clipping, which knows nothing of separating axes.
#include "triangle_polytope.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <set>

#include "box_tree.hpp"
#include "collision_mesh.hpp"
#include "core/mesh_shapes.hpp"
#include "random.hpp"

using namespace bin_picking;
using namespace bin_picking::simulation;

namespace
{
/// How far the triangle reaches into the body, more or less: > 0 if anything of it is left when it is cut to the body
/// drawn in by so much.
bool isCut(const ConvexBody& body, const Triangle& triangle, double drawn_in)
{
  std::vector<Eigen::Vector3d> polygon(triangle.begin(), triangle.end());
  for (const Eigen::Vector4d& plane : body.planes)
  {
    std::vector<Eigen::Vector3d> rest;
    for (std::size_t k = 0; k < polygon.size(); ++k)
    {
      const Eigen::Vector3d& a = polygon[k];
      const Eigen::Vector3d& b = polygon[(k + 1) % polygon.size()];
      const double at_a = plane.head<3>().dot(a) + plane[3] + drawn_in;
      const double at_b = plane.head<3>().dot(b) + plane[3] + drawn_in;
      if (at_a <= 0)
        rest.push_back(a);
      if ((at_a < 0) != (at_b < 0))
        rest.push_back(a + (b - a) * at_a / (at_a - at_b));
    }
    polygon = rest;
  }
  return !polygon.empty();
}

Pose randomPose(Random& random, double reach)
{
  Pose T = Pose::Identity();
  T.linear() = random.rotation().toRotationMatrix();
  T.translation() = reach * random.inBall();
  return T;
}

/// Some boxes, some hulls with a dozen faces.
ConvexBody randomBody(Random& random)
{
  if (random.below(2) == 0)
    return makeBox(Eigen::Vector3d::Zero(),
                   {random.uniform(0.01, 0.1), random.uniform(0.01, 0.1), random.uniform(0.01, 0.1)});
  std::vector<Eigen::Vector3d> points;
  for (int k = 0; k < 9; ++k)
    points.emplace_back(0.06 * random.inBall());
  return makeHull(points);
}

Triangle randomTriangle(Random& random)
{
  const double size = random.uniform(0.002, 0.1);
  return {size * random.inBall(), size * random.inBall(), size * random.inBall()};
}

ConvexBody movedBy(const ConvexBody& body, const Eigen::Vector3d& motion)
{
  return transformed(body, Pose(Eigen::Translation3d(motion)));
}
}  // namespace

TEST(TrianglePolytope, overlapIsWhatClippingLeaves)
{
  Random random(1);
  int inside = 0;
  int outside = 0;
  for (int k = 0; k < 20000; ++k)
  {
    const ConvexBody body = transformed(randomBody(random), randomPose(random, 0.08));
    const Triangle triangle = randomTriangle(random);
    const bool result = overlap(body, triangle);
    // The tolerance of a touch is 1 um; cases closer to a touch than ten times that are left out.
    if (isCut(body, triangle, 1e-5))
    {
      EXPECT_TRUE(result) << k;
      ++inside;
    }
    else if (!isCut(body, triangle, -1e-5))
    {
      EXPECT_FALSE(result) << k;
      ++outside;
    }
  }
  EXPECT_GT(inside, 2000);
  EXPECT_GT(outside, 2000);
}

TEST(TrianglePolytope, timesOfAMotionAreThoseOfManySmallSteps)
{
  Random random(2);
  constexpr int STEPS = 400;
  int hits = 0;
  for (int k = 0; k < 300; ++k)
  {
    const ConvexBody body = transformed(randomBody(random), randomPose(random, 0.1));
    const Triangle triangle = randomTriangle(random);
    const Eigen::Vector3d motion = 0.3 * random.inBall();
    const TimeSpan span = overlapTimes(body, motion, triangle, {0, 1});
    hits += !span.empty();
    for (int i = 0; i <= STEPS; ++i)
    {
      const double t = static_cast<double>(i) / STEPS;
      const ConvexBody there = movedBy(body, t * motion);
      if (isCut(there, triangle, 1e-5))
        EXPECT_TRUE(span.begin <= t && t <= span.end) << k << " at " << t;
      else if (!isCut(there, triangle, -1e-5))
        EXPECT_TRUE(span.empty() || t < span.begin || t > span.end) << k << " at " << t;
    }
  }
  EXPECT_GT(hits, 50);
}

TEST(TrianglePolytope, thinObstaclesAreNotJumpedOver)
{
  const ConvexBody finger = makeBox({0, 0, 0}, {0.02, 0.01, 0.08});
  const Triangle sheet = {Eigen::Vector3d(-1, -1, -0.1), Eigen::Vector3d(1, -1, -0.1), Eigen::Vector3d(0, 1, -0.1)};
  const TimeSpan span = overlapTimes(finger, {0, 0, -0.2}, sheet);
  EXPECT_NEAR(span.begin, (0.1 - 0.04) / 0.2, 1e-4);
  EXPECT_NEAR(span.end, (0.1 + 0.04) / 0.2, 1e-4);
  EXPECT_TRUE(overlapTimes(finger, {0, 0, 0.2}, sheet, {0, 1}).empty()) << "away from it";
  EXPECT_TRUE(overlapTimes(finger, {0.2, 0, 0}, sheet, {0, 1}).empty()) << "beside it";
}

TEST(TrianglePolytope, slidingAlongAFaceIsNoOverlap)
{
  const ConvexBody finger = makeBox({0, 0, 0.04}, {0.02, 0.01, 0.08});
  const Triangle floor = {Eigen::Vector3d(-1, -1, 0), Eigen::Vector3d(1, -1, 0), Eigen::Vector3d(0, 1, 0)};
  EXPECT_TRUE(overlapTimes(finger, {0.1, 0.05, 0}, floor, {0, 1}).empty());
  EXPECT_FALSE(overlapTimes(finger, {0.1, 0.05, -1e-5}, floor, {0, 1}).empty());
}

TEST(TrianglePolytope, depthIsWhatPartsThem)
{
  const ConvexBody body = makeBox({0, 0, 0}, {0.02, 0.02, 0.02});
  const Triangle floor = {Eigen::Vector3d(-1, -1, -0.0085), Eigen::Vector3d(1, -1, -0.0085),
                          Eigen::Vector3d(0, 1, -0.0085)};
  EXPECT_FALSE(overlapTimes(body, Eigen::Vector3d::Zero(), floor, {}, 0.0014).empty());
  EXPECT_TRUE(overlapTimes(body, Eigen::Vector3d::Zero(), floor, {}, 0.0016).empty());
}

TEST(BoxTree, findsWhatLookingAtAllFinds)
{
  Random random(3);
  std::vector<Eigen::AlignedBox3d> boxes;
  for (int k = 0; k < 500; ++k)
  {
    const Eigen::Vector3d p = random.inBall();
    boxes.emplace_back(p, p + Eigen::Vector3d(random.uniform(0, 0.1), random.uniform(0, 0.1), 0));
  }
  const BoxTree tree(boxes);
  for (int k = 0; k < 200; ++k)
  {
    const Eigen::Vector3d p = random.inBall();
    const Eigen::AlignedBox3d wanted(p, p + Eigen::Vector3d::Constant(random.uniform(0, 0.3)));
    std::multiset<std::size_t> found;
    tree.visit(wanted, [&found](std::size_t i) { found.insert(i); });
    std::multiset<std::size_t> expected;
    for (std::size_t i = 0; i < boxes.size(); ++i)
      if (boxes[i].intersects(wanted))
        expected.insert(i);
    EXPECT_EQ(found, expected);
  }
}

TEST(CollisionMesh, knowsDepthsAndTheFirstTouch)
{
  const CollisionMesh block(std::make_shared<TriangleMesh>(test::box(0.06f, 0.04f, 0.02f)));
  EXPECT_NEAR(block.depth({0.001, 0.002, 0.003}), 0.007, 1e-6);
  EXPECT_NEAR(block.depth({0.025, 0, 0.001}), 0.005, 1e-6);
  EXPECT_EQ(block.depth({0, 0, 0.011}), 0);
  EXPECT_EQ(block.depth({0.031, 0, 0}), 0);
  const ConvexBody finger = makeBox({0, 0, 0.1}, {0.01, 0.01, 0.02});
  const auto time = firstOverlap(block, finger, {0, 0, -0.1});
  ASSERT_TRUE(time);
  EXPECT_NEAR(*time, 0.8, 1e-4);
  EXPECT_FALSE(firstOverlap(block, finger, {0, 0, -0.1}, 0.79));
  EXPECT_FALSE(firstOverlap(block, finger, {0.1, 0, 0}));
}
