// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// How deep bodies reach into each other, where it is known.
#include "overlap.hpp"

#include <gtest/gtest.h>

#include "core/mesh_shapes.hpp"

using namespace bin_picking;
using namespace bin_picking::simulation;
using namespace bin_picking::test;

namespace
{
OverlapShape shapeOf(const TriangleMesh& mesh) { return OverlapShape(std::make_shared<TriangleMesh>(mesh)); }

Pose at(double x, double y, double z) { return Pose(Eigen::Translation3d(x, y, z)); }

/// Some rigid motion of all: the answer must not depend on it.
Pose somewhere()
{
  return Eigen::Translation3d(0.1, -0.2, 0.05) * Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized());
}
}  // namespace

TEST(Overlap, boxesPushedIntoEachOther)
{
  const OverlapShape cube = shapeOf(box(0.04f, 0.04f, 0.04f));
  for (const double depth : {0.0005, 0.002, 0.01})
    for (const Pose& T : {Pose::Identity(), somewhere()})
    {
      // Points in the middle of a face are deepest; the sides are farther away than that, up to 20 mm.
      const Overlap overlap = deepestOverlap({{&cube, T}, {&cube, T * at(0.04 - depth, 0, 0)}}, Executor(1));
      EXPECT_NEAR(overlap.depth, depth, 1e-8);
    }
}

TEST(Overlap, spheresPushedIntoEachOther)
{
  const OverlapShape sphere = shapeOf(sphereMesh(0.02f, 5));
  const Overlap overlap = deepestOverlap({{&sphere, Pose::Identity()}, {&sphere, at(0, 0.03, 0.026)}}, Executor(1));
  const double depth = 0.04 - std::hypot(0.03, 0.026);
  // Facets lie up to 0.02 mm below the sphere; a point within 1 mm of the deepest one is at most 1^2 / (2 20) mm
  // higher, against a surface that falls away as much.
  EXPECT_LT(overlap.depth, depth);
  EXPECT_GT(overlap.depth, depth - 0.0001);
}

TEST(Overlap, touchingAndSeparateBodiesDoNotOverlap)
{
  const OverlapShape cube = shapeOf(box(0.04f, 0.04f, 0.04f));
  EXPECT_EQ(deepestOverlap({{&cube, Pose::Identity()}, {&cube, at(0.0401, 0, 0)}}, Executor(1)).depth, 0);
  EXPECT_EQ(deepestOverlap({{&cube, Pose::Identity()}, {&cube, at(0.5, 0, 0)}}, Executor(1)).depth, 0);
  EXPECT_EQ(deepestOverlap({{&cube, Pose::Identity()}}, Executor(1)).depth, 0);
  EXPECT_EQ(deepestOverlap({}, Executor(1)).depth, 0);
}

TEST(Overlap, bodyWithinAnotherReachesFromItsSurface)
{
  const OverlapShape large = shapeOf(box(0.1f, 0.1f, 0.1f));
  const OverlapShape small = shapeOf(box(0.02f, 0.02f, 0.02f));
  const Overlap overlap = deepestOverlap({{&large, somewhere()}, {&small, somewhere()}}, Executor(1));
  EXPECT_NEAR(overlap.depth, 0.04, 1e-7);
}

TEST(Overlap, stickInTheBoreOfATubeDoesNotOverlap)
{
  const OverlapShape tube = shapeOf(tubeMesh(0.02f, 0.015f, 0.06f, 24));
  const OverlapShape stick = shapeOf(box(0.01f, 0.01f, 0.2f));
  EXPECT_EQ(deepestOverlap({{&tube, Pose::Identity()}, {&stick, Pose::Identity()}}, Executor(1)).depth, 0);
  EXPECT_GT(deepestOverlap({{&tube, Pose::Identity()}, {&stick, at(0.015, 0, 0)}}, Executor(1)).depth, 0.001);
}

TEST(Overlap, deepestPairIsNamedForAnyNumberOfThreads)
{
  const OverlapShape cube = shapeOf(box(0.04f, 0.04f, 0.04f));
  const std::vector<PlacedShape> row = {
      {&cube, at(0, 0, 0)}, {&cube, at(0.039, 0, 0)}, {&cube, at(0.076, 0, 0)}, {&cube, at(0.114, 0, 0)}};
  for (const int threads : {1, 4})
  {
    const Overlap overlap = deepestOverlap(row, Executor(threads));
    EXPECT_NEAR(overlap.depth, 0.003, 1e-8);
    EXPECT_EQ(std::min(overlap.first, overlap.second), 1u);
    EXPECT_EQ(std::max(overlap.first, overlap.second), 2u);
  }
}
