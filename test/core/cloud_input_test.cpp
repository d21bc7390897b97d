// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <fstream>
#include <iterator>
#include <random>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/scene/cloud_input.hpp"
#include "core/analytic_scenes.hpp"

using namespace bin_picking;
using namespace bin_picking::test;
using Cloud = pcl::PointCloud<pcl::PointXYZ>;

namespace
{
const float NAN_VALUE = std::numeric_limits<float>::quiet_NaN();

DepthGrid someScene()
{
  return render({sphere({0.02, 0, 0.75}, 0.05), plane({0, 0, 0.8}, {0.3, -0.1, -1})}, 80, 60, {200, 210, 41.5, 27.25});
}

Cloud toCloud(const DepthGrid& grid, float scale = 1)
{
  Cloud cloud(static_cast<std::uint32_t>(grid.width), static_cast<std::uint32_t>(grid.height));
  for (std::size_t i = 0; i < grid.size(); ++i)
    cloud.points[i] = pcl::PointXYZ(scale * grid.x[i], scale * grid.y[i], scale * grid.z[i]);
  return cloud;
}

void expectFault(const Cloud& cloud, CloudFault fault, const std::string& text)
{
  try
  {
    makeGrid(cloud, InputParameters());
    FAIL() << "no error; expected: " << text;
  }
  catch (const CloudError& e)
  {
    EXPECT_EQ(static_cast<int>(e.fault()), static_cast<int>(fault)) << e.what();
    EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
  }
}

void writeText(const std::string& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }
}  // namespace

TEST(CloudInput, PinholeCameraIsRecovered)
{
  const DepthGrid truth = someScene();
  const DepthGrid grid = makeGrid(toCloud(truth), InputParameters());
  EXPECT_EQ(grid.width, 80);
  EXPECT_EQ(grid.height, 60);
  EXPECT_EQ(grid.z, truth.z);
  // The cloud is exact up to the rounding of floats.
  EXPECT_NEAR(grid.camera.fx, 200, 0.001);
  EXPECT_NEAR(grid.camera.fy, 210, 0.001);
  EXPECT_NEAR(grid.camera.cx, 41.5, 0.001);
  EXPECT_NEAR(grid.camera.cy, 27.25, 0.001);
}

TEST(CloudInput, CameraFitWithstandsStrayPoints)
{
  Cloud cloud = toCloud(someScene());
  std::mt19937 generator(1);
  for (int k = 0; k < 480; ++k)  // 10 %
    cloud.points[generator() % cloud.size()].x += 0.2f;
  const DepthGrid grid = makeGrid(cloud, InputParameters());
  EXPECT_NEAR(grid.camera.fx, 200, 0.5);
  EXPECT_NEAR(grid.camera.cx, 41.5, 0.2);
}

TEST(CloudInput, WhatIsNotMeasuredBecomesNan)
{
  Cloud cloud = toCloud(someScene());
  const float infinity = std::numeric_limits<float>::infinity();
  cloud.points[0] = {0, 0, 0};
  cloud.points[1] = {NAN_VALUE, 0, 0.5f};
  cloud.points[2] = {0, 0, infinity};
  cloud.points[3] = {-3.4e38f, 0, 0.8f};
  cloud.points[4].z = -0.8f;
  cloud.is_dense = true;  // not believed
  const DepthGrid grid = makeGrid(cloud, InputParameters());
  for (int i = 0; i < 5; ++i)
  {
    EXPECT_FALSE(grid.valid(i)) << i;
    EXPECT_TRUE(std::isnan(grid.point(i).x()) && std::isnan(grid.point(i).y())) << i;
  }
  EXPECT_EQ(numValid(grid), 80 * 60 - 5);
}

TEST(CloudInput, EveryBadCloudIsRefusedWithItsReason)
{
  expectFault(Cloud(), CloudFault::Empty, "empty");

  Cloud list = toCloud(someScene());
  list.width = static_cast<std::uint32_t>(list.size());
  list.height = 1;
  expectFault(list, CloudFault::Unorganized, "4800 x 1");

  Cloud broken = toCloud(someScene());
  broken.height = 61;
  expectFault(broken, CloudFault::BadLayout, "80 x 61");

  Cloud blind(20, 10);
  for (auto& p : blind)
    p = {NAN_VALUE, NAN_VALUE, NAN_VALUE};
  expectFault(blind, CloudFault::AllInvalid, "200 are NaN");
  for (auto& p : blind)
    p = {0, 0, 0};
  expectFault(blind, CloudFault::AllInvalid, "200 are (0, 0, 0)");

  expectFault(toCloud(someScene(), 1000), CloudFault::UnitSuspect, "millimetres");
}

TEST(CloudInput, CloudsOfNoPinholeCameraAreRefused)
{
  Cloud shuffled = toCloud(someScene());
  std::mt19937 generator(2);
  for (std::size_t i = shuffled.size() - 1; i > 0; --i)
    std::swap(shuffled.points[i], shuffled.points[generator() % (i + 1)]);
  expectFault(shuffled, CloudFault::NoProjection, "median");

  Cloud parallel = toCloud(someScene());  // an orthographic height map
  for (std::size_t i = 0; i < parallel.size(); ++i)
  {
    parallel.points[i].x = 0.001f * static_cast<float>(i % 80);
    parallel.points[i].y = 0.001f * static_cast<float>(i / 80);
    parallel.points[i].z = 0.3f + 0.2f * static_cast<float>(generator() % 100) / 100;
  }
  expectFault(parallel, CloudFault::NoProjection, "max_projection_error");

  Cloud mirrored = toCloud(someScene());
  for (auto& p : mirrored)
    p.x = -p.x;
  expectFault(mirrored, CloudFault::NoProjection, "mirrored");

  Cloud behind = toCloud(someScene(), -1);
  expectFault(behind, CloudFault::NoProjection, "optical frame");

  Cloud single(4, 4);
  for (auto& p : single)
    p = {NAN_VALUE, NAN_VALUE, NAN_VALUE};
  single.points[5] = {0.1f, 0.1f, 0.8f};
  expectFault(single, CloudFault::NoProjection, "fewer than three");
}

TEST(CloudInput, LimitsCutTheRegion)
{
  DepthGrid grid = someScene();
  InputParameters limits;
  limits.x_min = -0.05;
  limits.x_max = 0.06;
  limits.y_max = 0.04;
  limits.z_max = 0.81;
  const int before = numValid(grid);
  cropToRegion(grid, limits, nullptr, Executor(1));
  EXPECT_GT(numValid(grid), 100);
  EXPECT_LT(numValid(grid), before);
  for (int i = 0; i < static_cast<int>(grid.size()); ++i)
  {
    if (!grid.valid(i))
      continue;
    const Eigen::Vector3f p = grid.point(i);
    EXPECT_TRUE(p.x() >= -0.05f && p.x() <= 0.06f && p.y() <= 0.04f && p.z() <= 0.81f) << p.transpose();
  }
}

TEST(CloudInput, TheBinKeepsWhatLiesAboveItsFloorAndBetweenItsWalls)
{
  // Floor at 0.8 m facing the camera; a box top 50 mm above it, one 150 mm above it (higher than the rim), one outside.
  DepthGrid grid = render({plane({0, 0, 0.8}, {0, 0, -1}), rectangle({-0.05, 0, 0.75}, 0.04, 0.04),
                           rectangle({0.05, 0, 0.65}, 0.04, 0.04), rectangle({0, 0.11, 0.75}, 0.04, 0.02)});
  Bin bin;
  bin.T_camera_bin.translation() = Eigen::Vector3d(0, 0, 0.8);
  bin.T_camera_bin.linear() = Eigen::AngleAxisd(PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
  bin.inner_size = {0.3, 0.16, 0.1};
  InputParameters parameters;
  parameters.bin_wall_margin = 0.01;
  cropToRegion(grid, parameters, &bin, Executor(1));
  int on_box = 0;
  int above_rim = 0;
  for (int i = 0; i < static_cast<int>(grid.size()); ++i)
  {
    if (!grid.valid(i))
      continue;
    const Eigen::Vector3f p = grid.point(i);
    EXPECT_LT(p.z(), 0.797f);
    EXPECT_LT(std::abs(p.y()), 0.0701f);
    on_box += std::abs(p.z() - 0.75f) < 0.001f;
    above_rim += std::abs(p.z() - 0.65f) < 0.001f;
  }
  EXPECT_GT(on_box, 1500);
  EXPECT_GT(above_rim, 1500);
}

TEST(CloudInput, PcdFilesSurviveARoundTrip)
{
  DepthGrid grid = someScene();
  grid.invalidate(17);
  const std::string path = testing::TempDir() + "round_trip.pcd";
  saveGrid(grid, path);
  const DepthGrid loaded = loadGrid(path, InputParameters());
  ASSERT_EQ(loaded.width, grid.width);
  EXPECT_FALSE(loaded.valid(17));
  for (int i = 18; i < static_cast<int>(grid.size()); ++i)
    ASSERT_EQ(loaded.point(i), grid.point(i));
}

TEST(CloudInput, BadFilesAreRefused)
{
  const std::string path = testing::TempDir() + "bad.pcd";
  EXPECT_THROW(loadGrid(testing::TempDir() + "does_not_exist.pcd", InputParameters()), FileError);
  EXPECT_THROW(loadGrid(testing::TempDir(), InputParameters()), FileError);
  EXPECT_THROW(saveGrid(someScene(), testing::TempDir() + "no_such_folder/a.pcd"), FileError);

  writeText(path, "");
  EXPECT_THROW(loadGrid(path, InputParameters()), FileError);
  writeText(path, "solid nothing like a point cloud\n");
  EXPECT_THROW(loadGrid(path, InputParameters()), FileError);
  writeText(path,
            "VERSION .7\nFIELDS x y intensity\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 2\n"
            "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA ascii\n0 0 1\n0 0 1\n0 0 1\n0 0 1\n");
  EXPECT_THROW(loadGrid(path, InputParameters()), FileError);

  writeText(path,
            "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 0\nHEIGHT 0\nPOINTS 0\nDATA ascii\n");
  EXPECT_THROW(loadGrid(path, InputParameters()), CloudError);

  saveGrid(someScene(), path);
  std::ifstream whole(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(whole)), std::istreambuf_iterator<char>());
  writeText(path, bytes.substr(0, bytes.size() / 2));
  EXPECT_THROW(loadGrid(path, InputParameters()), FileError);
}
