// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <cmath>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/mesh.hpp"
#include "mesh_shapes.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
TEST(SurfaceSampling, drawsAreaOverSpacingSquaredPointsOnTheSurface)
{
  const TriangleMesh box = test::box(0.06f, 0.04f, 0.02f);
  const OrientedPoints samples = sampleSurface(box, 0.001, 1);
  // 2 (60 * 40 + 40 * 20 + 60 * 20) mm^2
  EXPECT_EQ(samples.size(), 8800u);
  ASSERT_EQ(samples.normals.size(), samples.size());
  const Eigen::Vector3f half(0.03f, 0.02f, 0.01f);
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    Eigen::Index axis = 0;
    EXPECT_NEAR(samples.normals[i].cwiseAbs().maxCoeff(&axis), 1, 1e-6);
    // On the face that the normal names, outward, and within the box.
    EXPECT_NEAR(samples.points[i][axis], half[axis] * (samples.normals[i][axis] > 0 ? 1.f : -1.f), 1e-7f);
    EXPECT_TRUE((samples.points[i].cwiseAbs().array() <= half.array() + 1e-7f).all());
  }
}

TEST(SurfaceSampling, spreadsEvenlyOverSmallAndLargeTriangles)
{
  // One face of a box is two large triangles. Its 10 x 10 cells of 4 mm should hold 16 samples each. Independent draws
  // would vary with a standard deviation of 4; with one draw per equal compact area only the 20 or so shares that a
  // cell's border cuts vary, each by at most a quarter: sqrt(5) = 2.2.
  const OrientedPoints samples = sampleSurface(test::box(0.04f, 0.04f, 0.04f), 0.001, 3);
  std::vector<int> counts(100, 0);
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (samples.normals[i].z() > 0.5f)
    {
      const auto cell = [](float t) { return std::min(9, static_cast<int>((t + 0.02f) / 0.004f)); };
      ++counts[static_cast<std::size_t>(10 * cell(samples.points[i].x()) + cell(samples.points[i].y()))];
    }
  double variance = 0;
  for (const int count : counts)
    variance += (count - 16.0) * (count - 16.0) / 100;
  EXPECT_LT(std::sqrt(variance), 2.5);
  EXPECT_GT(*std::min_element(counts.begin(), counts.end()), 8);

  // A sphere of many small triangles: by Archimedes equal slices along z have equal areas.
  const OrientedPoints ball = sampleSurface(test::sphereMesh(0.02f, 4), 0.0005, 3);
  std::vector<int> slices(10, 0);
  for (const auto& p : ball.points)
    ++slices[static_cast<std::size_t>(std::min(9, static_cast<int>((p.z() + 0.02f) / 0.004f)))];
  for (const int count : slices)
    EXPECT_NEAR(count / (static_cast<double>(ball.size()) / 10), 1, 0.05);
}

TEST(SurfaceSampling, dependsOnTheSeedOnly)
{
  const TriangleMesh box = test::box(0.06f, 0.04f, 0.02f);
  const OrientedPoints first = sampleSurface(box, 0.002, 7);
  EXPECT_EQ(first.points, sampleSurface(box, 0.002, 7).points);
  EXPECT_NE(first.points, sampleSurface(box, 0.002, 8).points);
}

TEST(SurfaceSampling, skipsTrianglesWithoutArea)
{
  TriangleMesh box = test::box(0.06f, 0.04f, 0.02f);
  box.triangles.insert(box.triangles.begin(), {0, 0, 1});
  box.triangles.push_back({2, 2, 2});
  for (const auto& normal : sampleSurface(box, 0.002, 1).normals)
    EXPECT_NEAR(normal.norm(), 1, 1e-6);
}

TEST(SurfaceSampling, refusesUselessSpacings)
{
  const TriangleMesh box = test::box(0.06f, 0.04f, 0.02f);
  for (const double spacing : {0.0, -1.0, std::nan("")})
    test::expectWords(test::messageOf<ParameterError>([&] { sampleSurface(box, spacing, 1); }), {"must be positive"});
  test::expectWords(test::messageOf<ParameterError>([&] { sampleSurface(box, 1e-6, 1); }), {"20 million"});
  test::expectWords(test::messageOf<ParameterError>([&] { sampleSurface({}, 0.001, 1); }), {"without area"});
  EXPECT_EQ(sampleSurface(box, 1.0, 1).size(), 1u);
}
}  // namespace
}  // namespace bin_picking
