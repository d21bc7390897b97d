// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/scene/curvature.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "analytic_surfaces.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/scene/surface_resampling.hpp"

namespace bin_picking
{
namespace
{
// 40 000 points on these surfaces are about 0.5 mm apart: some 1200 neighbours within 10 mm.
constexpr std::size_t COUNT = 40000;

std::vector<float> curvatureOf(const OrientedPoints& surface, const OrientedPoints& queries, double radius,
                               CurvatureMeasure measure = CurvatureMeasure::MeanCurvature)
{
  return estimateCurvature(queries, surface, measure, radius, OPPOSITE_WALL_ANGLE, 8, Executor(2));
}

OrientedPoints some(const OrientedPoints& points, const std::function<bool(const Eigen::Vector3f&)>& wanted,
                    std::size_t most)
{
  std::vector<int> indices;
  for (std::size_t i = 0; i < points.size() && indices.size() < most; ++i)
    if (wanted(points.points[i]))
      indices.push_back(static_cast<int>(i));
  return select(points, indices);
}

const auto ANYWHERE = [](const Eigen::Vector3f&) { return true; };

TEST(QuadricCurvature, paraboloidIsExactAtItsApex)
{
  // z = -(x^2 / (2 R1) + y^2 / (2 R2)): principal curvatures 1/R1, 1/R2, convex towards +z.
  const SurfaceCurvature c = quadricCurvature(-1 / (2 * 0.01), 0, -1 / (2 * 0.04), 0, 0);
  EXPECT_NEAR(c.k1, 100, 1e-9);
  EXPECT_NEAR(c.k2, 25, 1e-9);
  EXPECT_NEAR(c.mean, 62.5, 1e-9);
  EXPECT_NEAR(c.gaussian, 2500, 1e-6);
}

TEST(QuadricCurvature, tiltedSphereKeepsItsCurvature)
{
  // Taylor expansion to second order of a sphere of radius R, seen from a frame tilted so that z_x = d, z_y = e there.
  const double R = 0.02;
  const double d = 0.3;
  const double e = -0.2;
  // z = sqrt(R^2 - (x - x0)^2 - (y - y0)^2) with slopes d, e: second derivatives follow from differentiating twice.
  const double w = 1 / std::sqrt(1 + d * d + e * e);
  const double z = R * w;
  const double zxx = -(1 + d * d) / z;
  const double zxy = -d * e / z;
  const double zyy = -(1 + e * e) / z;
  const SurfaceCurvature c = quadricCurvature(zxx / 2, zxy, zyy / 2, d, e);
  EXPECT_NEAR(c.k1, 1 / R, 1e-9);
  EXPECT_NEAR(c.k2, 1 / R, 1e-6);
}

TEST(MeanCurvature, planeIsFlat)
{
  const OrientedPoints surface = test::plane(0.1, COUNT);
  const auto middle = some(
      surface, [](const Eigen::Vector3f& p) { return p.head<2>().norm() < 0.04f; }, 100);
  for (const float h : curvatureOf(surface, middle, 0.01))
    EXPECT_NEAR(h, 0, 1e-3);
}

TEST(MeanCurvature, sphereIsOneOverR)
{
  const double R = 0.03;
  const OrientedPoints surface = test::sphere(R, COUNT);
  // A quadric over a cap of radius r misses the sphere's fourth-order term: relative error about (r / R)^2 / 4 = 0.7 %.
  for (const float h : curvatureOf(surface, some(surface, ANYWHERE, 200), 0.005))
    EXPECT_NEAR(h, 1 / R, 0.015 / R);
}

TEST(MeanCurvature, cylinderIsHalfOneOverR)
{
  const double R = 0.015;
  const OrientedPoints surface = test::cylinder(R, 0.1, COUNT);
  const auto middle = some(
      surface, [](const Eigen::Vector3f& p) { return std::abs(p.z()) < 0.04f; }, 200);
  for (const float h : curvatureOf(surface, middle, 0.004))
    EXPECT_NEAR(h, 0.5 / R, 0.02 / R);
}

TEST(MeanCurvature, concaveIsNegative)
{
  OrientedPoints bore = test::cylinder(0.015, 0.1, COUNT);
  for (auto& n : bore.normals)
    n = -n;  // seen from inside
  const auto middle = some(
      bore, [](const Eigen::Vector3f& p) { return std::abs(p.z()) < 0.04f; }, 50);
  for (const float h : curvatureOf(bore, middle, 0.004))
    EXPECT_NEAR(h, -0.5 / 0.015, 0.02 / 0.015);
}

TEST(MeanCurvature, torusInsideAndOutside)
{
  const double ring = 0.04;
  const double tube = 0.01;
  const OrientedPoints surface = test::torus(ring, tube, 2 * COUNT);
  const auto outer = some(
      surface, [&](const Eigen::Vector3f& p) { return p.head<2>().norm() > ring + 0.999 * tube; }, 50);
  const auto inner = some(
      surface, [&](const Eigen::Vector3f& p) { return p.head<2>().norm() < ring - 0.999 * tube; }, 50);
  ASSERT_GT(outer.size(), 10u);
  ASSERT_GT(inner.size(), 10u);
  for (const float h : curvatureOf(surface, outer, 0.003))
    EXPECT_NEAR(h, (1 / tube + 1 / (ring + tube)) / 2, 3);
  for (const float h : curvatureOf(surface, inner, 0.003))
    EXPECT_NEAR(h, (1 / tube - 1 / (ring - tube)) / 2, 3);
}

TEST(MeanCurvature, oppositeWallDoesNotCount)
{
  // Two faces of a 2 mm plate: without the test of the normals the quadric would mix them.
  OrientedPoints plate = test::plane(0.1, COUNT, 1);
  OrientedPoints back = test::plane(0.1, COUNT, 2);
  for (std::size_t i = 0; i < back.size(); ++i)
    test::add(plate, back.points[i].cast<double>() - Eigen::Vector3d(0, 0, 0.002), -Eigen::Vector3d::UnitZ());
  const auto middle = some(
      plate, [](const Eigen::Vector3f& p) { return p.head<2>().norm() < 0.04f; }, 50);
  for (const float h : curvatureOf(plate, middle, 0.01))
    EXPECT_NEAR(h, 0, 1e-3);
}

TEST(NormalVariation, knownValues)
{
  // Plane 0; cylinder: normals (sin(t), 0) with arc t = s / R, |s| < r: in a disc the mean of s^2 is r^2 / 4, so the
  // trace of the covariance is r^2 / (4 R^2) to second order, and the measure half of it.
  const OrientedPoints flat = test::plane(0.1, COUNT);
  for (const float v : curvatureOf(flat, some(flat, ANYWHERE, 50), 0.01, CurvatureMeasure::NormalVariation))
    EXPECT_NEAR(v, 0, 1e-6);
  const double R = 0.03;
  const double r = 0.006;
  const OrientedPoints tube = test::cylinder(R, 0.1, COUNT);
  const auto middle = some(
      tube, [](const Eigen::Vector3f& p) { return std::abs(p.z()) < 0.04f; }, 100);
  // 240 neighbours at random places: a single value scatters by 6 %, the mean of 100 overlapping discs by about 2 %.
  double mean = 0;
  for (const float v : curvatureOf(tube, middle, r, CurvatureMeasure::NormalVariation))
    mean += static_cast<double>(v) / static_cast<double>(middle.size());
  EXPECT_NEAR(mean, r * r / (8 * R * R), 0.08 * r * r / (8 * R * R));
}

TEST(Curvature, invariantUnderMotionAndThreads)
{
  std::mt19937 random(3);
  const OrientedPoints surface = test::torus(0.04, 0.015, 8000);
  const Pose T = test::randomPose(random, 0.5);
  const OrientedPoints moved = transformed(surface, T);
  const auto executor = [](int threads) { return Executor(threads); };
  const auto at_home = estimateCurvature(surface, surface, CurvatureMeasure::MeanCurvature, 0.01, 1.8, 8, executor(1));
  const auto two = estimateCurvature(surface, surface, CurvatureMeasure::MeanCurvature, 0.01, 1.8, 8, executor(2));
  const auto away = estimateCurvature(moved, moved, CurvatureMeasure::MeanCurvature, 0.01, 1.8, 8, executor(1));
  EXPECT_EQ(at_home, two);
  for (std::size_t i = 0; i < at_home.size(); ++i)
    EXPECT_NEAR(at_home[i], away[i], 0.5);  // float coordinates half a metre away: 3e-8 m against sagittae of 1e-3 m
}

TEST(Curvature, tooFewNeighboursIsNan)
{
  const OrientedPoints surface = test::plane(0.1, 40);
  for (const float h : curvatureOf(surface, surface, 0.002))
    EXPECT_TRUE(std::isnan(h));
}

TEST(VoxelDownsample, keepsBothFacesOfAnEdge)
{
  OrientedPoints edge;
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i)
  {
    test::add(edge, {test::uniform(random, 0, 0.02), test::uniform(random, 0, 0.02), 0}, Eigen::Vector3d::UnitZ());
    test::add(edge, {0, test::uniform(random, 0, 0.02), -test::uniform(random, 0, 0.02)}, -Eigen::Vector3d::UnitX());
  }
  const OrientedPoints sampled = voxelDownsample(edge, 0.005);
  for (const auto& n : sampled.normals)
    EXPECT_GT(std::max(n.z(), -n.x()), 0.999f) << "a normal was averaged across the edge";
  EXPECT_NEAR(static_cast<double>(sampled.size()), 2 * 16, 6);
}
}  // namespace
}  // namespace bin_picking
