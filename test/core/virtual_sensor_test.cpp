// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// Geometry of the virtual sensor: where it sees what, and where its second eye keeps it from measuring.
#include "sensor.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "bin_picking_perception/common/error.hpp"
#include "core/mesh_shapes.hpp"
#include "virtual_sensor_scenes.hpp"

using namespace bin_picking;
using namespace bin_picking::simulation;
using namespace bin_picking::test;

namespace
{
/// Measured depths are floats of about a metre.
constexpr double FLOAT_ROUNDING = 1.2e-7;

/// Index of the first and the last lost pixel of a row; {width, -1}: none.
std::pair<int, int> lostColumns(const DepthGrid& grid, int v)
{
  std::pair<int, int> lost = {grid.width, -1};
  for (int u = 0; u < grid.width; ++u)
    if (!grid.valid(grid.index(u, v)))
      lost = {std::min(lost.first, u), std::max(lost.second, u)};
  return lost;
}
}  // namespace

TEST(VirtualSensor, idealDepthOfATiltedPlaneIsExact)
{
  const Pose T = turnedAt(0.9, {1, 2, 0.3}, 0.8);
  const DepthGrid grid = gridOf(exactSensor(), {{plate(4, 4), T}});
  const Eigen::Vector3d normal = T.linear().col(2);
  for (int v = 0; v < HEIGHT; ++v)
    for (int u = 0; u < WIDTH; ++u)
    {
      const Eigen::Vector3d ray = grid.camera.backProject(u, v, 1);
      const double expected = normal.dot(T.translation()) / normal.dot(ray);
      ASSERT_NEAR(depthAt(grid, u, v), expected, FLOAT_ROUNDING * expected);
      const auto i = static_cast<std::size_t>(grid.index(u, v));
      ASSERT_NEAR(static_cast<double>(grid.x[i]), ray.x() * expected, FLOAT_ROUNDING * expected);
      ASSERT_NEAR(static_cast<double>(grid.y[i]), ray.y() * expected, FLOAT_ROUNDING * expected);
    }
}

TEST(VirtualSensor, idealDepthOfASphereIsThatOfItsFacets)
{
  const double radius = 0.05;
  const auto mesh = std::make_shared<TriangleMesh>(sphereMesh(static_cast<float>(radius), 6));
  const Eigen::Vector3d centre(0.01, -0.005, 0.8);
  const DepthGrid grid = gridOf(exactSensor(), {{mesh, at(centre.x(), centre.y(), centre.z())}});
  // The longest edge is an eighth of a turn / 2^5, twice that at worst; its sagitta is edge^2 / (8 radius), seen at 45
  // degrees at most.
  const double edge = radius * M_PI / 2 / 64 * 1.5;
  const double depth_error = edge * edge / (8 * radius) * 2 * std::sqrt(2.0);
  int num_checked = 0;
  for (int v = 0; v < HEIGHT; ++v)
    for (int u = 0; u < WIDTH; ++u)
    {
      const Eigen::Vector3d ray = grid.camera.backProject(u, v, 1).normalized();
      const double along = ray.dot(centre);
      const double miss = (centre - along * ray).norm();
      if (miss > radius * (1 + 1e-6))
      {
        ASSERT_TRUE(std::isnan(depthAt(grid, u, v))) << u << " " << v;
      }
      if (miss > 0.7 * radius)
        continue;
      const double expected = (along - std::sqrt(radius * radius - miss * miss)) * ray.z();
      ASSERT_GE(depthAt(grid, u, v), expected - FLOAT_ROUNDING);
      ASSERT_LE(depthAt(grid, u, v), expected + depth_error);
      ++num_checked;
    }
  EXPECT_GT(num_checked, 2000);
}

TEST(VirtualSensor, projectorOnTheRightThrowsShadowsToTheLeft)
{
  SensorParameters parameters = exactSensor();
  parameters.baseline = 0.1;
  const double near = 0.7;
  const double far = 0.8;
  const DepthGrid grid = gridOf(parameters, {wall(far), {plate(0.04f, 0.04f), at(0, 0, near)}});
  const int middle = HEIGHT / 2;
  const auto [first, last] = lostColumns(grid, middle);
  // The plate's left edge at depth `near` shades the wall over f b (1 / near - 1 / far) pixels beside it.
  const double width = grid.camera.fx * parameters.baseline * (1 / near - 1 / far);
  EXPECT_NEAR(last - first + 1, width, 1.01);
  EXPECT_NEAR(last + 0.5, grid.camera.cx - 0.02 * grid.camera.fx / near, 1.01);
  // Above and below the plate's shadow nothing is lost.
  EXPECT_EQ(lostColumns(grid, 2).second, -1);
}

TEST(VirtualSensor, secondCameraWithAParallelAxisDoesNotSeeTheLeftBorder)
{
  SensorParameters parameters = exactSensor();
  parameters.baseline = 0.02;
  parameters.second_field_of_view = parameters.field_of_view;
  const DepthGrid grid = gridOf(parameters, {wall(0.8)});
  const auto [first, last] = lostColumns(grid, HEIGHT / 2);
  EXPECT_EQ(first, 0);
  EXPECT_NEAR(last + 1, grid.camera.fx * parameters.baseline / 0.8, 1);

  parameters.convergence = 0.8;
  EXPECT_EQ(lostColumns(gridOf(parameters, {wall(0.8)}), HEIGHT / 2).second, -1);
}

TEST(VirtualSensor, grazingSurfacesAreLostInBothDirections)
{
  SensorParameters parameters = exactSensor();
  parameters.field_of_view = 0.02;  // one angle for all pixels, within 0.6 degrees
  parameters.light.max_incidence = 1.2;
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  EXPECT_EQ(validShare(gridOf(parameters, {{plate(4, 4), turnedAt(1.17, y, 0.8)}})), 1);
  EXPECT_EQ(validShare(gridOf(parameters, {{plate(4, 4), turnedAt(1.23, y, 0.8)}})), 0);
  EXPECT_EQ(validShare(gridOf(parameters, {{plate(4, 4), turnedAt(-1.23, y, 0.8)}})), 0);

  // From 0.2 m to the right at 0.8 m the same plates appear 0.245 rad flatter or steeper.
  parameters.baseline = 0.2;
  const double apart = std::atan2(0.2, 0.8);
  EXPECT_EQ(validShare(gridOf(parameters, {{plate(4, 4), turnedAt(1.17 - apart, y, 0.8)}})), 1);
  EXPECT_EQ(validShare(gridOf(parameters, {{plate(4, 4), turnedAt(1.23 - apart, y, 0.8)}})), 0);
  EXPECT_EQ(validShare(gridOf(parameters, {{plate(4, 4), turnedAt(-1.17, y, 0.8)}})), 1);
}

TEST(VirtualSensor, aHalfCoveredPlateIsHalfVisible)
{
  SensorParameters parameters = exactSensor();
  VirtualSensor sensor(parameters, 1);
  const auto lower = plate(0.06f, 0.04f);
  const Scan alone = sensor.scan({{lower, at(0, 0, 0.8)}}, 1);
  // 0.06 m x 0.04 m at 0.8 m, counted in whole columns and rows.
  const double focal = sensor.camera().fx;
  EXPECT_NEAR(alone.views[0].pixels_alone, 0.06 * focal / 0.8 * 0.04 * focal / 0.8, 0.02 * alone.views[0].pixels_alone);
  EXPECT_EQ(alone.views[0].visible_fraction, 1);

  // A plate whose left edge runs through the middle, in front.
  const Scan covered = sensor.scan({{lower, at(0, 0, 0.8)}, {plate(0.2f, 0.2f), at(0.1, 0, 0.7)}}, 1);
  EXPECT_EQ(covered.views[0].pixels_alone, alone.views[0].pixels_alone);
  EXPECT_NEAR(covered.views[0].visible_fraction, 0.5, 0.005);
  EXPECT_EQ(covered.views[0].valid_pixels, covered.views[0].visible_pixels);
  EXPECT_EQ(covered.views[1].visible_fraction, 1);
  const auto label = [&](int u) { return covered.labels[static_cast<std::size_t>(covered.grid.index(u, HEIGHT / 2))]; };
  EXPECT_EQ(label(2), -1);
  EXPECT_EQ(label(WIDTH / 2 - 10), 0);
  EXPECT_EQ(label(WIDTH / 2 + 10), 1);
}

TEST(VirtualSensor, aHiddenObjectIsNotVisibleButHasASilhouette)
{
  const Scan scan = VirtualSensor(exactSensor(), 1).scan({wall(0.5), {plate(0.05f, 0.05f), at(0, 0, 0.8)}}, 1);
  EXPECT_GT(scan.views[1].pixels_alone, 1000);
  EXPECT_EQ(scan.views[1].visible_pixels, 0);
  EXPECT_EQ(scan.views[1].visible_fraction, 0);
}

TEST(VirtualSensor, meshesAreKeptFromScanToScanAndForgottenWithTheirOwner)
{
  VirtualSensor sensor(exactSensor(), 1);
  std::weak_ptr<const TriangleMesh> observed;
  {
    const auto mesh = plate(0.1f, 0.1f);
    observed = mesh;
    const DepthGrid first = sensor.scan({{mesh, at(0, 0, 0.8)}}, 1).grid;
    const DepthGrid second = sensor.scan({{mesh, at(0, 0, 0.9)}}, 1).grid;
    EXPECT_NEAR(depthAt(first, 100, 80), 0.8, 1e-6);
    EXPECT_NEAR(depthAt(second, 100, 80), 0.9, 1e-6);
  }
  EXPECT_EQ(validShare(sensor.scan({}, 1).grid), 0);
  EXPECT_TRUE(observed.expired());
}

TEST(VirtualSensor, saysWhatIsWrongWithObjects)
{
  VirtualSensor sensor(exactSensor(), 1);
  EXPECT_THROW(sensor.scan({{nullptr, at(0, 0, 1)}}, 1), ParameterError);
  EXPECT_THROW(sensor.scan({{std::make_shared<TriangleMesh>(), at(0, 0, 1)}}, 1), ParameterError);
  auto broken = std::make_shared<TriangleMesh>(*plate(1, 1));
  broken->triangles[1][2] = 17;
  EXPECT_THROW(sensor.scan({{broken, at(0, 0, 1)}}, 1), ParameterError);
  EXPECT_THROW(sensor.scan({{plate(1, 1), at(0, std::numeric_limits<double>::quiet_NaN(), 1)}}, 1), ParameterError);
  EXPECT_EQ(validShare(sensor.scan({wall(0.8)}, 1).grid), 1);  // and works on
}

TEST(VirtualSensor, saysWhatIsWrongWithParameters)
{
  SensorParameters parameters;
  parameters.noise.depth_noise = -0.001;
  EXPECT_THROW(VirtualSensor{parameters}, ParameterError);
  parameters = SensorParameters();
  parameters.width = 0;
  EXPECT_THROW(VirtualSensor{parameters}, ParameterError);
  parameters = SensorParameters();
  parameters.edges.window = 4;
  EXPECT_THROW(VirtualSensor{parameters}, ParameterError);
  parameters = SensorParameters();
  parameters.light.albedo = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(VirtualSensor{parameters}, ParameterError);
}

TEST(VirtualSensor, namingAClassLoadsItsDefaults)
{
  for (const SensorClass type : {SensorClass::StructuredLight, SensorClass::Stereo, SensorClass::Ideal})
  {
    SensorParameters expected = sensorDefaults(type);
    EXPECT_NO_THROW(VirtualSensor(expected, 1));
    const std::string name = listParameters(visitor(expected))[0].value;
    for (const SensorClass start : {SensorClass::StructuredLight, SensorClass::Stereo})
    {
      SensorParameters parameters = sensorDefaults(start);
      setParameter(visitor(parameters), "type", name);
      EXPECT_EQ(toYaml(visitor(parameters)), toYaml(visitor(expected)));
    }
  }
  // Naming the class that it already is keeps what was set.
  SensorParameters parameters;
  parameters.noise.depth_noise = 0.0007;
  setParameter(visitor(parameters), "type=structured_light");
  EXPECT_EQ(parameters.noise.depth_noise, 0.0007);
}
