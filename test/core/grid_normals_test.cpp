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
/// Largest and mean angle between estimated and true normals over the pixels that `use` admits, degrees.
struct AngleError
{
  double mean = 0;
  double largest = 0;
  int count = 0;
};

template <typename Truth>
AngleError angleError(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& normals, const Truth& truth)
{
  AngleError error;
  for (std::size_t i = 0; i < grid.size(); ++i)
  {
    Eigen::Vector3d expected;
    if (std::isnan(normals[i].x()) || !truth(grid.point(static_cast<int>(i)).template cast<double>(), expected))
      continue;
    const double angle = degreesBetween(normals[i], expected.cast<float>());
    error.mean += angle;
    error.largest = std::max(error.largest, angle);
    ++error.count;
  }
  error.mean /= std::max(1, error.count);
  return error;
}
}  // namespace

TEST(GridNormals, PlanesOfAnyTiltAreExact)
{
  for (const double tilt : {0.0, 0.5, 0.9, 1.15, 1.3})
  {
    const Eigen::Vector3d normal(std::sin(tilt), 0, -std::cos(tilt));
    const DepthGrid grid = render({plane({0, 0, 0.8}, normal)});
    const auto normals = estimateGridNormals(grid, 0.004, Executor(1));
    const AngleError error = angleError(grid, normals, [&](const Eigen::Vector3d& p, Eigen::Vector3d& n) {
      n = normal;
      return p.z() < 1.5;  // beyond, pixels of a steep plane are centimetres apart
    });
    EXPECT_GT(error.count, 10000) << tilt;
    // Inverse depth is exactly linear on a plane: only the rounding of float depths (6e-8 of 0.8 m) is left.
    EXPECT_LT(error.largest, 0.05) << tilt;
  }
}

TEST(GridNormals, SphereNormalsPointOutwardsToTheCamera)
{
  const Eigen::Vector3d centre(0.02, -0.01, 0.8);
  const DepthGrid grid = render({sphere(centre, 0.03)});
  const auto normals = estimateGridNormals(grid, 0.003, Executor(1));
  const AngleError error = angleError(grid, normals, [&](const Eigen::Vector3d& p, Eigen::Vector3d& n) {
    n = (p - centre).normalized();
    return -n.dot(p.normalized()) > std::cos(0.87);  // 50 degrees; beyond, the window reaches over the silhouette
  });
  EXPECT_GT(error.count, 1000);
  // A symmetric window is free of bias but for the third order of the surface, which grows towards the rim.
  EXPECT_LT(error.mean, 0.5);
  EXPECT_LT(error.largest, 2.0);
}

TEST(GridNormals, NoiseIsAveragedOverTheWindow)
{
  DepthGrid grid = render({plane({0, 0, 0.8}, {0.3, 0.1, -1})});
  addDepthNoise(grid, 0.0002, 7);
  const auto normals = estimateGridNormals(grid, 0.004, Executor(1));
  const Eigen::Vector3d truth = Eigen::Vector3d(0.3, 0.1, -1).normalized();
  const AngleError error = angleError(grid, normals, [&](const Eigen::Vector3d&, Eigen::Vector3d& n) {
    n = truth;
    return true;
  });
  // A disc of radius 4.5 pixels of 1 mm has 69 pixels with a spread of about 2.2 mm: sigma of a slope is
  // 0.2 / (2.2 sqrt(69)) = 0.011 rad, of the angle (two slopes) about 0.8 degrees in the mean.
  EXPECT_LT(error.mean, 1.0);
  EXPECT_GT(error.mean, 0.2);  // else the noise was not there
}

TEST(GridNormals, DepthEdgesAreNotBlended)
{
  // A plate 15 mm above another: without regard to the edge, normals near it would lean over.
  const DepthGrid grid = render({rectangle({0, 0, 0.785}, 0.1, 0.1), plane({0, 0, 0.8}, {0, 0, -1})});
  const auto normals = estimateGridNormals(grid, 0.005, Executor(1));
  const AngleError error = angleError(grid, normals, [](const Eigen::Vector3d&, Eigen::Vector3d& n) {
    n = -Eigen::Vector3d::UnitZ();
    return true;
  });
  EXPECT_EQ(error.count, numValid(grid));
  EXPECT_LT(error.largest, 0.1);
}

TEST(GridNormals, SteepSurfacesStayConnected)
{
  // 75 degrees at a pitch of 1 mm: neighbours differ by 3.7 mm, as much as many real edges do.
  const double tilt = 75 * PI / 180;
  const DepthGrid grid = render({plane({0, 0, 0.8}, {std::sin(tilt), 0, -std::cos(tilt)})});
  const ConnectedRuns runs = connectedRuns(grid, EdgeRule(), Executor(1));
  const auto centre = static_cast<std::size_t>(grid.index(160, 128));
  EXPECT_GE(runs.left[centre], 8);
  EXPECT_GE(runs.right[centre], 8);
}

TEST(GridNormals, MixedPixelsDoNotBridgeAnEdge)
{
  DepthGrid grid = makeGrid(16, 4, {800, 800, 8, 2});
  for (int v = 0; v < 4; ++v)
    for (int u = 0; u < 16; ++u)
    {
      const double z = u < 7 ? 0.80 : (u == 7 ? 0.81 : 0.82);  // one pixel half-way down
      const Eigen::Vector3d p = grid.camera.backProject(u, v, z);
      const auto i = static_cast<std::size_t>(grid.index(u, v));
      grid.x[i] = static_cast<float>(p.x());
      grid.y[i] = static_cast<float>(p.y());
      grid.z[i] = static_cast<float>(p.z());
    }
  const ConnectedRuns runs = connectedRuns(grid, EdgeRule(), Executor(1));
  const auto row = static_cast<std::size_t>(grid.index(0, 1));
  EXPECT_EQ(runs.right[row], 6);
  EXPECT_EQ(runs.right[row + 7], 0);
  EXPECT_EQ(runs.left[row + 15], 7);
  EXPECT_EQ(runs.down[row + 3], 2);
  EXPECT_EQ(runs.up[row + 3], 1);
}

TEST(GridNormals, NothingIsInventedWhereThereIsNoPlane)
{
  DepthGrid grid = render({rectangle({0, 0.0005, 0.8}, 0.1, 0.0009)});  // one row of pixels
  ASSERT_GT(numValid(grid), 50);
  for (const auto& normal : estimateGridNormals(grid, 0.004, Executor(1)))
    EXPECT_TRUE(std::isnan(normal.x()));
  EXPECT_TRUE(estimateGridNormals(makeGrid(0, 0, testCamera()), 0.004, Executor(1)).empty());
}

TEST(GridNormals, SameBitsForAnyNumberOfThreads)
{
  DepthGrid grid = render({sphere({0.02, 0, 0.8}, 0.04), plane({0, 0, 0.82}, {0.2, 0, -1})});
  addDepthNoise(grid, 0.0003, 3);
  const auto one = estimateGridNormals(grid, 0.004, Executor(1));
  const auto two = estimateGridNormals(grid, 0.004, Executor(2));
  ASSERT_EQ(one.size(), two.size());
  EXPECT_EQ(0, std::memcmp(one.data(), two.data(), one.size() * sizeof(one[0])));
}

namespace
{
double noiseOf(const DepthGrid& grid) { return estimateDepthNoise(grid, connectedRuns(grid, EdgeRule(), Executor(1))); }
}  // namespace

TEST(DepthNoise, IsMeasuredOnTiltedAndCurvedSurfaces)
{
  for (const double sigma : {0.0001, 0.0003, 0.001})
  {
    DepthGrid grid = render({plane({0, 0, 0.8}, {0.5, 0.2, -1}), cylinder({0, 0, 0.79}, {0, 1, 0}, 0.04)});
    addDepthNoise(grid, sigma, 11);
    // Thousands of windows: the statistical error is below 1 %. Noise as large as a depth edge (1 mm and the slope)
    // cuts off its own tails, which takes a tenth of it.
    EXPECT_NEAR(noiseOf(grid), sigma, 0.12 * sigma);
  }
}

TEST(DepthNoise, TakesNoCurvatureForNoise)
{
  // A shaft of 8 mm radius sags by a quarter of a millimetre within two pixels of 1 mm from its crest, five times the
  // noise; what a quadric leaves of that, the fourth order, stays below the noise.
  const double sigma = 0.00005;
  DepthGrid grid = render({cylinder({0, 0, 0.8}, {1, 0.2, 0}, 0.008)});
  addDepthNoise(grid, sigma, 7);
  EXPECT_NEAR(noiseOf(grid), sigma, 0.3 * sigma);
}

TEST(DepthNoise, IsZeroWithoutNoiseAndWithoutPlanes)
{
  EXPECT_LT(noiseOf(render({plane({0, 0, 0.8}, {0.5, 0.2, -1})})), 1e-6);
  EXPECT_EQ(noiseOf(makeGrid(20, 20, testCamera())), 0);
}
