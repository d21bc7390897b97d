// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"
#include "core/analytic_scenes.hpp"

using namespace bin_picking;
using namespace bin_picking::test;

namespace
{
void setPoint(DepthGrid& grid, int u, int v, double z)
{
  const Eigen::Vector3d p = grid.camera.backProject(u, v, z);
  const auto i = static_cast<std::size_t>(grid.index(u, v));
  grid.x[i] = static_cast<float>(p.x());
  grid.y[i] = static_cast<float>(p.y());
  grid.z[i] = static_cast<float>(z);
}

SceneSamples sample(const DepthGrid& grid, double leaf, const PreprocessingParameters& parameters = {})
{
  return sampleScene(grid, estimateGridNormals(grid, 0.003, Executor(1)), leaf, parameters);
}
}  // namespace

TEST(ReduceGrid, PointsStayOnTheSurfaceAndOnTheirRays)
{
  const Eigen::Vector3d normal = Eigen::Vector3d(0.4, 0.2, -1).normalized();
  const DepthGrid grid = render({plane({0, 0, 0.8}, normal)}, 321, 257);  // neither divides by the factor
  for (const int factor : {2, 3, 4})
  {
    const DepthGrid reduced = reduceGrid(grid, factor, Executor(1));
    EXPECT_EQ(reduced.width, (321 + factor - 1) / factor);
    EXPECT_EQ(reduced.height, (257 + factor - 1) / factor);
    EXPECT_EQ(numValid(reduced), reduced.width * reduced.height);
    for (int v = 0; v < 257 / factor; ++v)
      for (int u = 0; u < 321 / factor; ++u)
      {
        const Eigen::Vector3d p = reduced.point(reduced.index(u, v)).cast<double>();
        EXPECT_LT(std::abs(normal.dot(p - Eigen::Vector3d(0, 0, 0.8))), 1e-6);
        // On a tilted plane the mean point leaves the middle ray by far less than a pixel.
        EXPECT_LT((reduced.camera.project(p) - Eigen::Vector2d(u, v)).norm(), 0.05);
      }
  }
}

TEST(ReduceGrid, DepthEdgesAreNotAveraged)
{
  // A plate 50 mm above a floor, its edge in the middle of blocks.
  const DepthGrid grid = render({rectangle({0.0013, 0.0007, 0.75}, 0.1, 0.1), plane({0, 0, 0.8}, {0, 0, -1})});
  const DepthGrid reduced = reduceGrid(grid, 4, Executor(1));
  for (const float z : reduced.z)
    EXPECT_TRUE(std::abs(z - 0.75f) < 1e-5f || std::abs(z - 0.8f) < 1e-5f) << z;
}

TEST(ReduceGrid, AMixedBlockKeepsItsLargerSurfaceAndANearTieTheNearerOne)
{
  DepthGrid grid = makeGrid(4, 2, {800, 800, 0, 0});
  setPoint(grid, 0, 0, 0.9);
  setPoint(grid, 1, 0, 0.8);
  setPoint(grid, 0, 1, 0.9);
  setPoint(grid, 1, 1, 0.9);
  setPoint(grid, 2, 0, 0.9);
  setPoint(grid, 3, 0, 0.8);
  const DepthGrid reduced = reduceGrid(grid, 2, Executor(1));
  EXPECT_FLOAT_EQ(reduced.z[0], 0.9f);
  EXPECT_FLOAT_EQ(reduced.z[1], 0.8f);
}

TEST(ReduceGrid, FactorOneCopiesAndZeroIsRefused)
{
  const DepthGrid grid = render({sphere({0, 0, 0.8}, 0.05)});
  const DepthGrid copy = reduceGrid(grid, 1, Executor(1));
  EXPECT_EQ(copy.width, grid.width);
  EXPECT_EQ(numValid(copy), numValid(grid));
  EXPECT_THROW(reduceGrid(grid, 0, Executor(1)), ParameterError);
}

TEST(ReductionFactor, BringsThePitchToAShareOfTheLeaf)
{
  const PreprocessingParameters parameters;                         // three pixels per leaf
  const DepthGrid grid = render({plane({0, 0, 0.8}, {0, 0, -1})});  // pitch 1 mm
  EXPECT_EQ(reductionFactor(grid, 0.003, parameters), 1);
  EXPECT_EQ(reductionFactor(grid, 0.006, parameters), 2);
  EXPECT_EQ(reductionFactor(grid, 0.015, parameters), 5);
  EXPECT_EQ(reductionFactor(grid, 0.0005, parameters), 1);
  EXPECT_EQ(reductionFactor(makeGrid(10, 10, testCamera()), 0.003, parameters), 1);
}

TEST(RemoveOutliers, StrayPointsGoAndSurfacesStay)
{
  const double tilt = 65 * PI / 180;
  DepthGrid grid = render({plane({0, 0, 0.8}, {std::sin(tilt), 0, -std::cos(tilt)}, [](const Eigen::Vector3d& p) {
    return std::abs(p.x()) < 0.05 && std::abs(p.y()) < 0.05;
  })});
  const int surface = numValid(grid);
  ASSERT_GT(surface, 3000);
  setPoint(grid, 10, 10, 0.6);    // alone in the empty
  setPoint(grid, 160, 128, 0.7);  // in front of the surface
  setPoint(grid, 170, 128, 0.9);  // behind it
  removeOutliers(grid, PreprocessingParameters(), Executor(1));
  EXPECT_FALSE(grid.valid(grid.index(10, 10)));
  EXPECT_FALSE(grid.valid(grid.index(160, 128)));
  EXPECT_FALSE(grid.valid(grid.index(170, 128)));
  EXPECT_GE(numValid(grid), surface - 2 - 4);  // the steep surface stays whole; each corner may lose its last pixel

  DepthGrid kept = render({sphere({0, 0, 0.8}, 0.0011)});
  PreprocessingParameters off;
  off.outlier_window = 0;
  const int few = numValid(kept);
  ASSERT_GT(few, 0);
  removeOutliers(kept, off, Executor(1));
  EXPECT_EQ(numValid(kept), few);
  removeOutliers(kept, PreprocessingParameters(), Executor(1));
  EXPECT_EQ(numValid(kept), 0);  // a speck of two pixels
}

TEST(SampleScene, OnePointPerLeafOnTheSurface)
{
  const Eigen::Vector3d normal = Eigen::Vector3d(0.2, 0.1, -1).normalized();
  const DepthGrid grid = render({plane({0, 0, 0.8}, normal)});
  const SceneSamples samples = sample(grid, 0.004);
  // Voxels of 4 mm cut by a plane of 320 x 256 mm^2 / cos: at least one per column of voxels, up to twice as many.
  const double columns = 320.0 * 256 / 16;
  EXPECT_GT(samples.size(), 0.95 * columns);
  EXPECT_LT(samples.size(), 2.0 * columns);
  std::set<std::array<int, 3>> voxels;
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    const Eigen::Vector3d p = samples.points[i].cast<double>();
    EXPECT_LT(std::abs(normal.dot(p - Eigen::Vector3d(0, 0, 0.8))), 1e-6);
    EXPECT_LT(degreesBetween(samples.normals[i], normal.cast<float>()), 0.1);
    EXPECT_LT((grid.point(samples.pixel[i]).cast<double>() - p).norm(), 0.0035);  // half a voxel's diagonal
    voxels.insert({static_cast<int>(std::floor(p.x() / 0.004)), static_cast<int>(std::floor(p.y() / 0.004)),
                   static_cast<int>(std::floor(p.z() / 0.004))});
  }
  EXPECT_EQ(voxels.size(), samples.size());  // never two in a voxel of one surface
  EXPECT_TRUE(std::is_sorted(samples.pixel.begin(), samples.pixel.end()));
}

TEST(SampleScene, CreasesKeepBothSurfacesUnlessSwitchedOff)
{
  // A roof: two planes at right angles, the ridge along y in the middle of a column of voxels.
  const double leaf = 0.012;
  const Eigen::Vector3d top(leaf / 2, 0, 0.75);
  const DepthGrid grid = render({plane(top, {1, 0, -1}, [&](const Eigen::Vector3d& p) { return p.x() > top.x(); }),
                                 plane(top, {-1, 0, -1}, [&](const Eigen::Vector3d& p) { return p.x() <= top.x(); })});
  // Samples of the ridge's voxels that face clearly to one side; the faces' normals have x = +-0.71.
  const auto count = [&](const SceneSamples& samples, float sign) {
    int faces = 0;
    for (std::size_t i = 0; i < samples.size(); ++i)
      faces += samples.points[i].x() > 0 && static_cast<double>(samples.points[i].x()) < leaf &&
               samples.points[i].z() < 0.756f && sign * samples.normals[i].x() > 0.5f;
    return faces;
  };
  PreprocessingParameters merged;
  merged.split_by_normal = false;
  const SceneSamples split_samples = sample(grid, leaf);
  EXPECT_GT(count(split_samples, 1), 10);
  EXPECT_GT(count(split_samples, -1), 10);
  const SceneSamples merged_samples = sample(grid, leaf, merged);
  EXPECT_EQ(count(merged_samples, 1), 0);
  EXPECT_EQ(count(merged_samples, -1), 0);
}

TEST(SampleScene, SurfacesSeenTooFlatlyAreLeftOut)
{
  const double tilt = 75 * PI / 180;
  const DepthGrid grid = render({plane({0, 0, 0.8}, {0, std::sin(tilt), -std::cos(tilt)},
                                       [](const Eigen::Vector3d& p) { return std::abs(p.z() - 0.8) < 0.1; })});
  PreprocessingParameters parameters;
  EXPECT_GT(sample(grid, 0.003, parameters).size(), 1000u);
  parameters.max_normal_tilt = 1.2;
  EXPECT_TRUE(sample(grid, 0.003, parameters).empty());
}

TEST(SampleScene, NothingComesFromNothing)
{
  const DepthGrid empty = makeGrid(32, 24, testCamera());
  EXPECT_TRUE(sample(empty, 0.003).empty());
  EXPECT_TRUE(std::isnan(medianDepth(empty)));
}

TEST(PreprocessingParameters, DefaultsAreWithinTheirRanges)
{
  PreprocessingParameters parameters;
  for (const auto& entry : listParameters(visitor(parameters)))
    EXPECT_NO_THROW(setParameter(visitor(parameters), entry.path, entry.value)) << entry.path;
}
