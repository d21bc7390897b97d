// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// What the virtual sensor does wrong on purpose: noise, steps, losses, edges.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "virtual_sensor_scenes.hpp"

using namespace bin_picking;
using namespace bin_picking::simulation;
using namespace bin_picking::test;

namespace
{
constexpr double SIGMA = 0.0002;
constexpr double WALL = 0.8;

SensorParameters noisySensor(double white_share, double correlation_length)
{
  SensorParameters parameters = exactSensor();
  parameters.reference_distance = WALL;
  parameters.noise.depth_noise = SIGMA;
  parameters.noise.white_share = white_share;
  parameters.noise.correlation_length = correlation_length;
  return parameters;
}

/// Mean product of the depth errors of pixels `lag` apart, along rows and columns.
double covariance(const DepthGrid& measured, const DepthGrid& truth, int lag)
{
  double sum = 0;
  int count = 0;
  const auto error = [&](int u, int v) { return depthAt(measured, u, v) - depthAt(truth, u, v); };
  for (int v = 0; v + lag < HEIGHT; ++v)
    for (int u = 0; u + lag < WIDTH; ++u, count += 2)
      sum += error(u, v) * (error(u + lag, v) + error(u, v + lag));
  return sum / count;
}

double deviation(const DepthGrid& measured, const DepthGrid& truth)
{
  return std::sqrt(covariance(measured, truth, 0));
}

bool sameBits(const std::vector<float>& a, const std::vector<float>& b)
{
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

/// A plate in front of a wall, its left edge in the middle of the picture between two pixels.
std::vector<SceneObject> stepScene() { return {wall(WALL), {plate(2, 2), at(1, 0, 0.7)}}; }
}  // namespace

TEST(SensorNoise, whiteNoiseHasTheGivenDeviationAndNoCorrelation)
{
  const DepthGrid truth = gridOf(exactSensor(), {wall(WALL)});
  const DepthGrid measured = gridOf(noisySensor(1, 1), {wall(WALL)});
  // 32000 pixels: the deviation is known to 0.4 %, a correlation to 0.4 %; four times that. The rays' incidence of up
  // to 7 degrees adds at most 0.8 %, 0.4 % on average.
  EXPECT_NEAR(deviation(measured, truth), SIGMA, 0.02 * SIGMA);
  EXPECT_NEAR(covariance(measured, truth, 1), 0, 0.016 * SIGMA * SIGMA);
}

TEST(SensorNoise, correlationFallsToOneOverEAtItsLength)
{
  const DepthGrid truth = gridOf(exactSensor(), {wall(WALL)});
  double variance = 0;
  double at_length = 0;
  double at_twice = 0;
  constexpr int NUM_SCANS = 4;
  for (std::uint32_t seed = 1; seed <= NUM_SCANS; ++seed)
  {
    const DepthGrid measured = gridOf(noisySensor(0, 4), {wall(WALL)}, seed);
    variance += covariance(measured, truth, 0) / NUM_SCANS;
    at_length += covariance(measured, truth, 4) / NUM_SCANS;
    at_twice += covariance(measured, truth, 8) / NUM_SCANS;
  }
  // A patch of pi / 2 length^2 = 25 pixels counts as one: 4 x 32000 / 25 of them give the variance to 2 %.
  EXPECT_NEAR(variance, SIGMA * SIGMA, 0.08 * SIGMA * SIGMA);
  EXPECT_NEAR(at_length / variance, std::exp(-1.0), 0.06);
  EXPECT_NEAR(at_twice / variance, std::exp(-4.0), 0.06);
}

TEST(SensorNoise, whiteShareIsTheDropOfTheCorrelationAtOnce)
{
  const DepthGrid truth = gridOf(exactSensor(), {wall(WALL)});
  const DepthGrid measured = gridOf(noisySensor(0.3, 6), {wall(WALL)});
  EXPECT_NEAR(covariance(measured, truth, 1) / covariance(measured, truth, 0), 0.7 * std::exp(-1.0 / 36), 0.04);
}

TEST(SensorNoise, growsWithTheSquareOfTheDistance)
{
  const SensorParameters noisy = noisySensor(0.5, 2);
  const double near = deviation(gridOf(noisy, {wall(0.8)}), gridOf(exactSensor(), {wall(0.8)}));
  const double far = deviation(gridOf(noisy, {wall(1.6)}), gridOf(exactSensor(), {wall(1.6)}));
  // The same seed draws the same noise, which only scales; depths are rounded to 1e-7 m.
  EXPECT_NEAR(far / near, 4, 0.01);
}

TEST(SensorNoise, growsWithTheIncidence)
{
  SensorParameters noisy = noisySensor(0.5, 2);
  SensorParameters exact = exactSensor();
  noisy.field_of_view = exact.field_of_view = 0.01;  // so that distance and incidence are one for the whole picture
  const SceneObject tilted = {plate(4, 4), turnedAt(M_PI / 3, Eigen::Vector3d::UnitX(), WALL)};
  const double frontal = deviation(gridOf(noisy, {wall(WALL)}), gridOf(exact, {wall(WALL)}));
  EXPECT_NEAR(deviation(gridOf(noisy, {tilted}), gridOf(exact, {tilted})) / frontal, 2, 0.05);
}

TEST(SensorNoise, biasIsTheSensorsOwnAndSmooth)
{
  SensorParameters parameters = exactSensor();
  parameters.reference_distance = WALL;
  parameters.noise.bias = SIGMA;
  parameters.noise.bias_length = 12;
  const DepthGrid truth = gridOf(exactSensor(), {wall(WALL)});
  const DepthGrid first = gridOf(parameters, {wall(WALL)}, 1);
  EXPECT_TRUE(sameBits(first.z, gridOf(parameters, {wall(WALL)}, 2).z));
  // 140 patches as large as the length: 6 % of the deviation.
  EXPECT_NEAR(deviation(first, truth), SIGMA, 0.2 * SIGMA);
  EXPECT_GT(covariance(first, truth, 2) / covariance(first, truth, 0), 0.93);
}

TEST(SensorNoise, depthsLieOnStepsOfDisparityAndOfDepth)
{
  SensorParameters parameters = noisySensor(1, 1);
  parameters.noise.depth_noise = 0.01;
  parameters.baseline = 0.05;
  parameters.noise.disparity_step = 0.125;
  const DepthGrid stepped = gridOf(parameters, {wall(WALL)});
  const double disparity_of_one_metre = stepped.camera.fx * parameters.baseline;
  for (int i = 0; i < static_cast<int>(stepped.size()); ++i)
  {
    const double steps = disparity_of_one_metre / static_cast<double>(stepped.z[static_cast<std::size_t>(i)]) / 0.125;
    ASSERT_NEAR(steps, std::round(steps), 1e-3);  // 500 steps, of which a float tells a part in 10 million
  }
  parameters.noise.disparity_step = 0;
  parameters.noise.depth_step = 0.001;
  const DepthGrid rounded = gridOf(parameters, {wall(WALL)});
  for (const float z : rounded.z)
    ASSERT_NEAR(static_cast<double>(z) * 1000, std::round(static_cast<double>(z) * 1000), 1e-4);
}

TEST(SensorNoise, tooLittleLightIsLostByTheSquareOfTheDistance)
{
  SensorParameters parameters = exactSensor();
  parameters.reference_distance = 0.5;
  parameters.light.albedo = 0.4;
  parameters.light.min_signal = 0.1;
  // Frontally, 0.4 (0.5 / z)^2 falls to 0.1 at 1 m; within 8 degrees, cosine and distance take 3 %, 1.4 % of the depth.
  EXPECT_EQ(validShare(gridOf(parameters, {wall(0.98)})), 1);
  EXPECT_EQ(validShare(gridOf(parameters, {wall(1.001)})), 0);
  parameters.light.albedo = 0.8;
  EXPECT_EQ(validShare(gridOf(parameters, {wall(1.38)})), 1);
}

TEST(SensorNoise, highlightsLieWhereTheNormalHalvesTheAngleToTheLight)
{
  SensorParameters parameters = exactSensor();
  parameters.baseline = 0.04;
  parameters.light.shininess = 1;
  parameters.light.highlight_width = 0.01;
  const DepthGrid grid = gridOf(parameters, {wall(WALL)});
  double u_sum = 0;
  double v_sum = 0;
  int lost = 0;
  for (int i = 0; i < static_cast<int>(grid.size()); ++i)
    if (!grid.valid(i))
    {
      u_sum += i % WIDTH;
      v_sum += i / WIDTH;
      ++lost;
    }
  // Half way to the projector: 0.02 m to the right. The lobe 1 / (1 + (r / w)^2)^2 with w = 0.01 rad = 10 pixels covers
  // pi w^2 = 314 pixels, give or take 13.
  EXPECT_NEAR(lost, 312, 60);
  EXPECT_NEAR(u_sum / lost, grid.camera.cx + 0.02 * grid.camera.fx / WALL, 3);
  EXPECT_NEAR(v_sum / lost, grid.camera.cy, 3);
}

TEST(SensorNoise, edgesLoseTheGivenWidthOnBothSides)
{
  SensorParameters parameters = exactSensor();
  parameters.edges.loss = 1;
  for (const int width : {1, 2, 4})
  {
    parameters.edges.loss_width = width;
    const DepthGrid grid = gridOf(parameters, stepScene());
    for (int u = 0; u < WIDTH; ++u)
      EXPECT_EQ(std::isnan(depthAt(grid, u, HEIGHT / 2)), u >= WIDTH / 2 - width && u < WIDTH / 2 + width) << u;
  }
  // A slope is no edge, however steep, nor is the crease between two.
  parameters.edges.jump = 0.001;
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  EXPECT_EQ(validShare(gridOf(parameters, {{plate(4, 4), turnedAt(1.3, y, WALL)}})), 1);
  EXPECT_EQ(validShare(gridOf(parameters, {{plate(4, 4), turnedAt(1, y, WALL)}, {plate(4, 4), turnedAt(-1, y, WALL)}})),
            1);
}

TEST(SensorNoise, lossesComeInPatches)
{
  SensorParameters parameters = exactSensor();
  parameters.edges.loss = 0.5;
  parameters.edges.loss_width = 1;
  const auto changes = [&](double size) {
    parameters.edges.loss_size = size;
    const DepthGrid grid = gridOf(parameters, stepScene());
    int count = 0;
    for (int v = 1; v < HEIGHT; ++v)
      count += std::isnan(depthAt(grid, WIDTH / 2, v)) != std::isnan(depthAt(grid, WIDTH / 2, v - 1)) ? 1 : 0;
    return count;
  };
  // Independent rows change half the time: 80 of 159, give or take 6; patches of 8 rows much more rarely.
  EXPECT_NEAR(changes(1), 80, 25);
  EXPECT_LT(changes(8), 45);
  EXPECT_GT(changes(8), 5);
}

TEST(SensorNoise, mixedPixelsLieBetweenTheTwoSurfaces)
{
  SensorParameters parameters = exactSensor();
  parameters.edges.mixed_pixels = 0.5;
  const DepthGrid grid = gridOf(parameters, stepScene());
  int mixed = 0;
  for (int v = 0; v < HEIGHT; ++v)
    for (int u = 0; u < WIDTH; ++u)
    {
      const double z = depthAt(grid, u, v);
      ASSERT_GE(z, 0.7 - 1e-6);
      ASSERT_LE(z, WALL + 1e-6);
      const bool is_between = z > 0.7 + 1e-5 && z < WALL - 1e-5;
      mixed += is_between ? 1 : 0;
      ASSERT_TRUE(!is_between || u == WIDTH / 2 - 1 || u == WIDTH / 2) << u;
    }
  EXPECT_NEAR(mixed, 0.5 * 2 * HEIGHT, 36);  // four standard deviations
}

TEST(SensorNoise, windowsMakePartsFatterAndKeepPlanesFlat)
{
  SensorParameters parameters = exactSensor();
  parameters.edges.window = 9;
  const auto near_columns = [&](double fattening) {
    parameters.edges.fattening = fattening;
    const DepthGrid grid = gridOf(parameters, stepScene());
    int count = 0;
    for (int u = 0; u < WIDTH; ++u)
      count += std::abs(depthAt(grid, u, HEIGHT / 2) - 0.7) < 1e-5 ? 1 : 0;
    return count;
  };
  EXPECT_EQ(near_columns(0.5), WIDTH / 2);
  EXPECT_EQ(near_columns(0.2), WIDTH / 2 + 3);  // two of the nine columns are enough
  const SceneObject tilted = {plate(4, 4), turnedAt(0.8, {1, 1, 0}, WALL)};
  const DepthGrid flat = gridOf(exactSensor(), {tilted});
  const DepthGrid matched = gridOf(parameters, {tilted});
  for (int v = 4; v < HEIGHT - 4; ++v)
    for (int u = 4; u < WIDTH - 4; ++u)
      ASSERT_NEAR(depthAt(matched, u, v), depthAt(flat, u, v), 2e-7);
}

TEST(SensorNoise, holesCoverTheGivenShare)
{
  SensorParameters parameters = exactSensor();
  parameters.noise.drop_outs = 0.05;
  // 1600 lost pixels give or take 39; in holes of 13 pixels 3.6 times as uncertain.
  EXPECT_NEAR(validShare(gridOf(parameters, {wall(WALL)})), 0.95, 0.005);
  parameters.noise.drop_out_size = 4;
  EXPECT_NEAR(validShare(gridOf(parameters, {wall(WALL)})), 0.95, 0.015);
}

TEST(SensorNoise, sameBitsForAnyNumberOfThreadsAndOtherBitsForAnotherSeed)
{
  for (const SensorClass type : {SensorClass::StructuredLight, SensorClass::Stereo})
  {
    SensorParameters parameters = sensorDefaults(type);
    parameters.width = WIDTH;
    parameters.height = HEIGHT;
    VirtualSensor one(parameters, 1);
    VirtualSensor two(parameters, 2);
    const Scan first = one.scan(stepScene(), 7);
    const Scan again = one.scan(stepScene(), 7);
    const Scan threaded = two.scan(stepScene(), 7);
    for (const Scan* other : {&again, &threaded})
    {
      EXPECT_TRUE(sameBits(first.grid.x, other->grid.x));
      EXPECT_TRUE(sameBits(first.grid.y, other->grid.y));
      EXPECT_TRUE(sameBits(first.grid.z, other->grid.z));
      EXPECT_EQ(first.labels, other->labels);
      EXPECT_EQ(first.views[1].valid_pixels, other->views[1].valid_pixels);
    }
    EXPECT_GT(validShare(first.grid), 0.3);
    const Scan other_seed = one.scan(stepScene(), 8);
    EXPECT_FALSE(sameBits(first.grid.z, other_seed.grid.z));
    EXPECT_EQ(first.labels, other_seed.labels);
  }
}
