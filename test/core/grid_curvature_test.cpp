// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <cstring>

#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"
#include "core/analytic_scenes.hpp"

using namespace bin_picking;
using namespace bin_picking::test;

namespace
{
constexpr double RADIUS = 0.010;
constexpr double MAX_NORMAL_ANGLE = 1.2;

SceneSamples samplesWithCurvature(const DepthGrid& grid, CurvatureMeasure measure,
                                  const Executor& executor = Executor(1), double radius = RADIUS)
{
  const ConnectedRuns runs = connectedRuns(grid, EdgeRule(), executor);
  const auto normals = estimateGridNormals(grid, runs, 0.004, executor);
  SceneSamples samples = sampleScene(grid, normals, 0.003, PreprocessingParameters());
  estimateGridCurvature(samples, grid, runs, normals, measure, radius, MAX_NORMAL_ANGLE, executor);
  return samples;
}

/// Mean and standard deviation of the curvature of the samples that `use` admits; all of them must be complete.
struct Spread
{
  double mean = 0;
  double deviation = 0;
  int count = 0;
};

template <typename Use>
Spread spreadOf(const SceneSamples& samples, const Use& use)
{
  Spread s;
  double squares = 0;
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    if (!use(samples.points[i]))
      continue;
    EXPECT_TRUE(samples.curvature_complete[i]) << samples.points[i].transpose();
    const double c = static_cast<double>(samples.curvature[i]);
    EXPECT_TRUE(std::isfinite(c));
    s.mean += c;
    squares += c * c;
    ++s.count;
  }
  s.mean /= s.count;
  s.deviation = std::sqrt(std::max(0.0, squares / s.count - s.mean * s.mean));
  return s;
}

bool inMiddle(const Eigen::Vector3f& p, float x, float y) { return std::abs(p.x()) < x && std::abs(p.y()) < y; }
}  // namespace

TEST(GridCurvature, PlaneHasNone)
{
  const DepthGrid grid = render({plane({0, 0, 0.8}, {0.4, -0.2, -1})});
  const auto middle = [](const Eigen::Vector3f& p) { return inMiddle(p, 0.1f, 0.08f); };
  const Spread h = spreadOf(samplesWithCurvature(grid, CurvatureMeasure::MeanCurvature), middle);
  EXPECT_GT(h.count, 1000);
  EXPECT_LT(std::abs(h.mean) + h.deviation, 0.05);  // 1/m: radii above 20 m
  const Spread variation = spreadOf(samplesWithCurvature(grid, CurvatureMeasure::NormalVariation), middle);
  EXPECT_LT(variation.mean, 1e-5);
}

TEST(GridCurvature, SphereIsOneOverItsRadius)
{
  for (const double radius : {0.03, 0.06})
  {
    const DepthGrid grid = render({sphere({0, 0, 0.8}, radius)});
    const Spread h =
        spreadOf(samplesWithCurvature(grid, CurvatureMeasure::MeanCurvature),
                 [&](const Eigen::Vector3f& p) { return p.head<2>().norm() < 0.4f * static_cast<float>(radius); });
    EXPECT_GT(h.count, 30);
    // A quadric over 10 mm does not follow a sphere's fourth order: z = x^2/2R (1 + x^2/4R^2 ...), up to + 5 % at 30
    // mm.
    EXPECT_NEAR(h.mean * radius, 1.0, 0.06);
    EXPECT_LT(h.deviation * radius, 0.03);
  }
}

TEST(GridCurvature, CylinderIsHalfOfThatInAnyDirection)
{
  const double radius = 0.025;
  for (const double angle : {0.0, 0.4, 1.1, 2.0})
  {
    const Eigen::Vector3d axis(std::cos(angle), std::sin(angle), 0.2);
    const DepthGrid grid = render({cylinder({0, 0, 0.8}, axis, radius)});
    const Spread h =
        spreadOf(samplesWithCurvature(grid, CurvatureMeasure::MeanCurvature), [&](const Eigen::Vector3f& p) {
          const double across = std::abs(p.x() * axis.y() - p.y() * axis.x()) / axis.head<2>().norm();
          return across < 0.4 * radius && inMiddle(p, 0.08f, 0.08f);
        });
    EXPECT_GT(h.count, 50) << angle;
    EXPECT_NEAR(h.mean * radius, 0.5, 0.03) << angle;
    EXPECT_LT(h.deviation * radius, 0.03) << angle;
  }
}

TEST(GridCurvature, SeenFromInsideItIsNegative)
{
  const DepthGrid grid = render({bowl({0, 0, 0.8}, 0.06)});
  const Spread h = spreadOf(samplesWithCurvature(grid, CurvatureMeasure::MeanCurvature),
                            [](const Eigen::Vector3f& p) { return p.head<2>().norm() < 0.02f; });
  EXPECT_GT(h.count, 50);
  EXPECT_NEAR(h.mean * 0.06, -1.0, 0.05);
}

TEST(GridCurvature, SaddlesHaveTheMeanOfTheirTwoCurvatures)
{
  const auto apex = [](const Eigen::Vector3f& p) { return p.head<2>().norm() < 0.003f; };
  const auto at = [&](double kx, double ky) {
    const Spread s =
        spreadOf(samplesWithCurvature(render({paraboloid(0.8, kx, ky)}), CurvatureMeasure::MeanCurvature), apex);
    EXPECT_GT(s.count, 0);
    return s.mean;
  };
  EXPECT_NEAR(at(20, -20), 0, 0.3);   // 1/m
  EXPECT_NEAR(at(30, -10), 10, 0.5);  // the inner side of a torus is such a surface
  EXPECT_NEAR(at(10, -30), -10, 0.5);
}

TEST(GridCurvature, NormalVariationOfACylinderFollowsTheRadiusSquared)
{
  // Normals across a cylinder are x / R; over a disc of radius r the variance of x is r^2/4: (pc1 + pc2) / 2 = r^2 /
  // 8R^2.
  const double radius = 0.03;
  const DepthGrid grid = render({cylinder({0, 0, 0.8}, {0, 1, 0}, radius)});
  for (const double r : {0.006, 0.010})
  {
    const Spread s = spreadOf(samplesWithCurvature(grid, CurvatureMeasure::NormalVariation, Executor(1), r),
                              [](const Eigen::Vector3f& p) { return inMiddle(p, 0.008f, 0.08f); });
    const double expected = r * r / (8 * radius * radius);
    EXPECT_NEAR(s.mean, expected, 0.1 * expected) << r;  // a lattice of pixels stands for the disc
  }
}

TEST(GridCurvature, NoiseAveragesOut)
{
  DepthGrid grid = render({cylinder({0, 0, 0.8}, {0, 1, 0}, 0.025)});
  addDepthNoise(grid, 0.0001, 5);
  const Spread h = spreadOf(samplesWithCurvature(grid, CurvatureMeasure::MeanCurvature),
                            [](const Eigen::Vector3f& p) { return inMiddle(p, 0.010f, 0.08f); });
  // sigma(H) of a quadric fit on n points over a disc of radius r is about 3.5 sigma / (r^2 sqrt(n)): n = 80: 0.4 1/m.
  EXPECT_NEAR(h.mean, 20, 1.0);
  EXPECT_LT(h.deviation, 1.2);
}

TEST(GridCurvature, NeighbourhoodsCutByAnEdgeAreMarked)
{
  const DepthGrid grid = render({rectangle({0, 0, 0.78}, 0.08, 0.08), plane({0, 0, 0.8}, {0, 0, -1})});
  const SceneSamples samples = samplesWithCurvature(grid, CurvatureMeasure::MeanCurvature);
  int edge_samples = 0;
  int inner_samples = 0;
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    const Eigen::Vector3f& p = samples.points[i];
    const float to_edge = 0.04f - p.head<2>().cwiseAbs().maxCoeff();
    if (p.z() > 0.785f || to_edge < 0)
      continue;
    if (to_edge < 0.003f)
    {
      EXPECT_FALSE(samples.curvature_complete[i]);
      ++edge_samples;
    }
    if (to_edge > 0.009f)
    {
      EXPECT_TRUE(samples.curvature_complete[i]);
      ++inner_samples;
    }
    // The lower plate, 20 mm away, must not bend the upper one.
    if (!std::isnan(samples.curvature[i]))
    {
      EXPECT_NEAR(samples.curvature[i], 0, 0.1);
    }
  }
  EXPECT_GT(edge_samples, 50);
  EXPECT_GT(inner_samples, 200);
}

TEST(GridCurvature, TiltedSurfacesAreCompleteToo)
{
  const double tilt = 1.0;  // 57 degrees: a pixel covers almost twice the area that it covers frontally
  const DepthGrid grid = render({plane({0, 0, 0.8}, {std::sin(tilt), 0, -std::cos(tilt)})});
  const Spread h = spreadOf(samplesWithCurvature(grid, CurvatureMeasure::MeanCurvature),
                            [](const Eigen::Vector3f& p) { return inMiddle(p, 0.05f, 0.08f); });
  EXPECT_GT(h.count, 500);
}

TEST(GridCurvature, TooFewNeighboursGiveNoNumber)
{
  const DepthGrid grid = render({rectangle({0, 0, 0.8}, 0.0035, 0.0025)});
  const SceneSamples samples = samplesWithCurvature(grid, CurvatureMeasure::MeanCurvature);
  ASSERT_FALSE(samples.empty());
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    EXPECT_TRUE(std::isnan(samples.curvature[i]));
    EXPECT_FALSE(samples.curvature_complete[i]);
  }
}

TEST(GridCurvature, SameBitsForAnyNumberOfThreads)
{
  DepthGrid grid = render({sphere({0.02, 0, 0.8}, 0.04), plane({0, 0, 0.82}, {0.2, 0, -1})});
  addDepthNoise(grid, 0.0003, 3);
  for (const auto measure : {CurvatureMeasure::MeanCurvature, CurvatureMeasure::NormalVariation})
  {
    const SceneSamples one = samplesWithCurvature(grid, measure, Executor(1));
    const SceneSamples two = samplesWithCurvature(grid, measure, Executor(2));
    ASSERT_EQ(one.size(), two.size());
    EXPECT_EQ(0, std::memcmp(one.curvature.data(), two.curvature.data(), one.size() * sizeof(float)));
    EXPECT_EQ(one.curvature_complete, two.curvature_complete);
  }
}
