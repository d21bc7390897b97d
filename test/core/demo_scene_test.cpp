// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "demo_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking::simulation
{
namespace
{
TriangleMesh demoPart(const std::string& name)
{
  return loadMesh(std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/" + name + "/" + name + ".stl",
                  LengthUnit::Millimetre);
}

DemoSceneParameters smallScene()
{
  DemoSceneParameters parameters;
  parameters.pile.count = 6;
  parameters.pile.shakes = 40;
  parameters.sensor.width = 320;
  parameters.sensor.height = 256;
  return parameters;
}

bool sameBits(const std::vector<float>& a, const std::vector<float>& b)
{
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

struct Column
{
  float lower = std::numeric_limits<float>::infinity();
  float upper = -std::numeric_limits<float>::infinity();
};

/// Extent in z per column, from surface samples much denser than the columns.
std::map<std::pair<int, int>, Column> columnsOf(const OrientedPoints& surface, const Pose& T_bin_object, float cell)
{
  std::map<std::pair<int, int>, Column> columns;
  for (const Eigen::Vector3f& p : transformed(surface, T_bin_object).points)
  {
    Column& column = columns[{static_cast<int>(std::floor(p.x() / cell)), static_cast<int>(std::floor(p.y() / cell))}];
    column.lower = std::min(column.lower, p.z());
    column.upper = std::max(column.upper, p.z());
  }
  return columns;
}

TEST(Pile, EachPartLiesAboveThoseBelowIt)
{
  const TriangleMesh part = demoPart("three_way_tube");
  PileParameters parameters;
  parameters.shakes = 30;
  parameters.bin_length = parameters.bin_width = 0.2;  // narrow: parts must lie on parts
  parameters.bin_height = 0.3;
  const std::vector<Pose> T_bin_objects = layPile(part, parameters);
  ASSERT_EQ(T_bin_objects.size(), 25u);
  const float cell = 0.0003f;
  const OrientedPoints surface = sampleSurface(part, 0.00025, 1);
  std::map<std::pair<int, int>, float> height;
  double smallest_gap = std::numeric_limits<double>::infinity();
  double smallest_height = std::numeric_limits<double>::infinity();
  for (const Pose& T_bin_object : T_bin_objects)
  {
    const auto columns = columnsOf(surface, T_bin_object, cell);
    for (const auto& [place, column] : columns)
    {
      smallest_height = std::min(smallest_height, static_cast<double>(column.lower));
      const auto below = height.find(place);
      if (below != height.end())
        smallest_gap = std::min(smallest_gap, static_cast<double>(column.lower - below->second));
    }
    for (const auto& [place, column] : columns)
      height[place] = std::max(height.count(place) ? height[place] : 0.0f, column.upper);
  }
  EXPECT_GT(smallest_gap, -0.001);
  EXPECT_GT(smallest_height, -0.001);
}

TEST(Pile, EveryPartLiesInsideTheBinAndTouchesSomething)
{
  const TriangleMesh part = demoPart("upright_column");
  PileParameters parameters;
  parameters.shakes = 30;
  const std::vector<Pose> T_bin_objects = layPile(part, parameters);
  double lowest_of_all = 1;
  for (const Pose& T_bin_object : T_bin_objects)
    for (const Eigen::Vector3f& vertex : part.vertices)
    {
      const Eigen::Vector3d p = T_bin_object * vertex.cast<double>();
      EXPECT_LE(std::abs(p.x()), parameters.bin_length / 2);
      EXPECT_LE(std::abs(p.y()), parameters.bin_width / 2);
      lowest_of_all = std::min(lowest_of_all, p.z());
    }
  EXPECT_NEAR(lowest_of_all, 0, 1e-6);  // float rounding of the profile
}

TEST(Pile, PartsComeToRestLow)
{
  // A column has its centre of mass 33 mm above its plate; on its side it lies at about 20 mm. Random attitudes held on
  // the floor by their lowest point have it at 45 mm on average.
  PileParameters parameters;
  parameters.count = 1;
  const TriangleMesh part = demoPart("upright_column");
  for (parameters.seed = 1; parameters.seed <= 5; ++parameters.seed)
  {
    const Pose T_bin_object = layPile(part, parameters).front();
    EXPECT_LT((T_bin_object * centerOfMass(part)).z(), 0.026) << "seed " << parameters.seed;
  }
}

TEST(Pile, CenterOfMassOfATetrahedronIsTheMeanOfItsCorners)
{
  TriangleMesh mesh;
  mesh.vertices = {{0.1f, 0.1f, 0.1f}, {0.2f, 0.1f, 0.1f}, {0.1f, 0.2f, 0.1f}, {0.1f, 0.1f, 0.3f}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  EXPECT_TRUE(centerOfMass(mesh).isApprox(Eigen::Vector3d(0.125, 0.125, 0.15), 1e-5));
  mesh.triangles.resize(1);  // an open sheet has no volume: the centre of its area
  EXPECT_TRUE(centerOfMass(mesh).isApprox(Eigen::Vector3d(0.4 / 3, 0.4 / 3, 0.1), 1e-5));
}

TEST(DemoScene, SameSeedSameBitsOtherSeedOtherScene)
{
  const TriangleMesh part = demoPart("three_way_tube");
  DemoSceneParameters parameters = smallScene();
  const DemoScene first = makeDemoScene(part, parameters);
  const DemoScene again = makeDemoScene(part, parameters);
  EXPECT_TRUE(sameBits(first.grid.x, again.grid.x));
  EXPECT_TRUE(sameBits(first.grid.y, again.grid.y));
  EXPECT_TRUE(sameBits(first.grid.z, again.grid.z));
  ASSERT_EQ(first.instances.size(), again.instances.size());
  for (std::size_t i = 0; i < first.instances.size(); ++i)
    EXPECT_EQ(first.instances[i].T_camera_object.matrix(), again.instances[i].T_camera_object.matrix());
  parameters.pile.seed = 2;
  EXPECT_FALSE(sameBits(first.grid.z, makeDemoScene(part, parameters).grid.z));
}

TEST(DemoScene, LonePartIsWhollyVisibleAndCoveredOnesAreNot)
{
  const TriangleMesh part = demoPart("three_way_tube");
  DemoSceneParameters parameters = smallScene();
  parameters.pile.count = 1;
  const DemoScene alone = makeDemoScene(part, parameters);
  EXPECT_EQ(alone.instances.front().visible_fraction, 1);
  EXPECT_EQ(alone.instances.front().visible_pixels, std::count(alone.labels.begin(), alone.labels.end(), 0));
  parameters.pile.count = 25;
  parameters.pile.bin_length = parameters.pile.bin_width = 0.2;
  parameters.pile.bin_height = 0.3;
  const DemoScene heap = makeDemoScene(part, parameters);
  double least = 1;
  for (const DemoInstance& instance : heap.instances)
  {
    EXPECT_GE(instance.visible_fraction, 0);
    EXPECT_LE(instance.visible_fraction, 1);
    least = std::min(least, instance.visible_fraction);
  }
  EXPECT_LT(least, 0.5);
}

TEST(DemoScene, PointsOfAPartLieOnItsSurfaceAtTheTruePose)
{
  const TriangleMesh part = demoPart("upright_column");
  const DemoSceneParameters parameters = smallScene();
  const DemoScene scene = makeDemoScene(part, parameters);
  int measured = 0;
  for (std::size_t i = 0; i < scene.labels.size(); ++i)
    if (scene.labels[i] >= 0 && scene.grid.valid(static_cast<int>(i)))
    {
      const auto& T_camera_object = scene.instances[static_cast<std::size_t>(scene.labels[i])].T_camera_object;
      const Eigen::Vector3d p = T_camera_object.inverse() * scene.grid.point(static_cast<int>(i)).cast<double>();
      // Inside the bounding box of the part; noise stays below six sigma at the largest incidence.
      EXPECT_LT(std::abs(p.x()), 0.033);
      EXPECT_LT(std::abs(p.y()), 0.025);
      EXPECT_NEAR(p.z(), 0.055, 0.058);
      ++measured;
    }
  EXPECT_GT(measured, 3000);
}

/// Deviations in depth from the floor of an empty bin, in units of the standard deviation that holds there.
std::vector<double> floorNoise(const DemoSceneParameters& parameters, const DemoScene& scene)
{
  const Eigen::Vector3d normal = scene.bin.T_camera_bin.linear().col(2);
  const double height = normal.dot(scene.bin.T_camera_bin.translation());
  std::vector<double> noise(scene.grid.size(), std::nan(""));
  for (int v = 0; v < scene.grid.height; ++v)
    for (int u = 0; u < scene.grid.width; ++u)
    {
      const int i = scene.grid.index(u, v);
      const Eigen::Vector3d ray = scene.grid.camera.backProject(u, v, 1);
      const double depth = height / normal.dot(ray);
      const Eigen::Vector3d p_bin = scene.bin.T_camera_bin.inverse() * (depth * ray);
      if (!scene.grid.valid(i) || (p_bin.array().abs().head<2>() > Eigen::Array2d(0.15, 0.1)).any())
        continue;  // walls and rim
      const double cosine = std::abs(normal.dot(ray.normalized()));
      const double sigma = parameters.sensor.depth_noise * std::pow(depth / 0.8, 2) / cosine;
      noise[static_cast<std::size_t>(i)] = (scene.grid.point(i).z() - depth) / sigma;
    }
  return noise;
}

TEST(DemoScene, NoiseHasTheStatedSpreadAndIsCorrelatedALittle)
{
  DemoSceneParameters parameters = smallScene();
  parameters.pile.count = 0;
  parameters.sensor.depth_noise = 0.0005;
  const DemoScene scene = makeDemoScene({}, parameters);
  const std::vector<double> noise = floorNoise(parameters, scene);
  double sum = 0, squares = 0, products = 0;
  int count = 0;
  for (std::size_t i = 0; i + 1 < noise.size(); ++i)
    if (!std::isnan(noise[i]) && !std::isnan(noise[i + 1]))
    {
      sum += noise[i];
      squares += noise[i] * noise[i];
      products += noise[i] * noise[i + 1];
      ++count;
    }
  ASSERT_GT(count, 15000);
  // Some 15000 correlated samples: standard errors 0.015 and 0.01.
  EXPECT_NEAR(sum / count, 0, 0.05);
  EXPECT_NEAR(std::sqrt(squares / count), 1, 0.04);
  EXPECT_NEAR(products / squares, 0.44, 0.04);  // 2 w / (1 + 2 w^2), w = 0.25
}

TEST(DemoScene, WithoutNoisePointsLieOnTheRaysAndTheFloor)
{
  DemoSceneParameters parameters = smallScene();
  parameters.pile.count = 0;
  parameters.sensor.depth_noise = 0;
  const DemoScene scene = makeDemoScene({}, parameters);
  parameters.sensor.depth_noise = 1;  // floorNoise() then returns metres
  for (const double deviation : floorNoise(parameters, scene))
  {
    if (!std::isnan(deviation))
    {
      EXPECT_NEAR(deviation, 0, 2e-6);
    }
  }
}

TEST(DemoScene, ProjectorBesideTheBinLeavesTheFloorBehindItsWallDark)
{
  DemoSceneParameters parameters = smallScene();
  parameters.pile.count = 0;
  parameters.sensor.tilt = 0;
  parameters.sensor.baseline = 0.4;  // 0.2 m beyond the wall at x = 0.2 m
  const DemoScene scene = makeDemoScene({}, parameters);
  double rightmost = -1;
  double leftmost = 1;
  for (int u = 0; u < scene.grid.width; ++u)
  {
    const Eigen::Vector3f p = scene.grid.point(scene.grid.index(u, scene.grid.height / 2));
    if (std::isnan(p.z()) || std::abs(p.z() - 0.8) > 0.005)
      continue;
    rightmost = std::max(rightmost, static_cast<double>(p.x()));
    leftmost = std::min(leftmost, static_cast<double>(p.x()));
  }
  // The ray over the wall's inner edge, 0.15 m high, falls by 0.65 m over 0.2 m. Pixels are 1.9 mm wide there.
  EXPECT_NEAR(rightmost, 0.2 - 0.15 * 0.2 / 0.65, 0.005);
  EXPECT_NEAR(leftmost, -0.2, 0.005);
}

TEST(DemoScene, NothingIsMeasuredAtGrazingIncidence)
{
  DemoSceneParameters parameters = smallScene();
  parameters.pile.count = 0;
  parameters.sensor.tilt = 0.5;
  parameters.sensor.max_incidence = 0.4;  // the floor is seen at 0.5 and more or less beside the axis
  const DemoScene scene = makeDemoScene({}, parameters);
  const auto noise = floorNoise(parameters, scene);
  const Eigen::Vector3d normal = scene.bin.T_camera_bin.linear().col(2);
  for (int i = 0; i < static_cast<int>(noise.size()); ++i)
  {
    if (!std::isnan(noise[static_cast<std::size_t>(i)]))
    {
      EXPECT_GT(std::abs(normal.dot(scene.grid.point(i).cast<double>().normalized())), std::cos(0.42));
    }
  }
}

TEST(DemoScene, WhatCannotBeIsRefusedWithTheNumbers)
{
  const TriangleMesh part = demoPart("three_way_tube");
  const auto messageOf = [&](const DemoSceneParameters& parameters) -> std::string {
    try
    {
      makeDemoScene(part, parameters);
    }
    catch (const ParameterError& error)
    {
      return error.what();
    }
    return "";
  };
  DemoSceneParameters parameters = smallScene();
  parameters.pile.bin_length = parameters.pile.bin_width = 0.04;
  EXPECT_NE(messageOf(parameters).find("does not fit"), std::string::npos);
  parameters = smallScene();
  parameters.pile.count = 200;
  parameters.pile.attempts = 2;
  parameters.pile.bin_height = 0.05;
  EXPECT_NE(messageOf(parameters).find("of 200 would lie above the rim"), std::string::npos);
  parameters = smallScene();
  parameters.sensor.baseline = -1;
  EXPECT_NE(messageOf(parameters).find("sensor/baseline"), std::string::npos);
}
}  // namespace
}  // namespace bin_picking::simulation
