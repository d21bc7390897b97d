// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
//
// What organized clouds tell about the noise, the losses and the edges of their sensor, real and virtual by the same
// measure: one line per cloud and one of the medians.
// Usage: benchmark_sensor_noise [CLOUD.pcd ...] [--simulate structured_light|stereo|ideal] [--set parameter=value ...]
//                               [--scenes N] [--save FOLDER]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/scene/cloud_input.hpp"
#include "noise_figures.hpp"
#include "sensor_scene.hpp"

using namespace bin_picking;
using namespace bin_picking::simulation;

namespace
{
struct Options
{
  std::vector<std::string> clouds;
  std::string simulate;
  std::vector<std::string> overrides;
  int scenes = 6;
  std::string save;
};

Options parseOptions(int argc, char** argv)
{
  Options options;
  for (int i = 1; i < argc; ++i)
  {
    const std::string word = argv[i];
    if (word.rfind("--", 0) != 0)
    {
      options.clouds.push_back(word);
      continue;
    }
    if (i + 1 == argc)
      throw ParameterError("option '" + word + "' needs a value");
    const std::string value = argv[++i];
    if (word == "--simulate")
      options.simulate = value;
    else if (word == "--set")
      options.overrides.push_back(value);
    else if (word == "--scenes")
      options.scenes = static_cast<int>(parseQuantity(value, ""));
    else if (word == "--save")
      options.save = value;
    else
      throw ParameterError("unknown option '" + word + "'; known are --simulate, --set, --scenes and --save");
  }
  if (options.scenes < 1)
    throw ParameterError("--scenes is " + std::to_string(options.scenes) + ", but it must be at least 1");
  if (options.clouds.empty() && options.simulate.empty())
    throw ParameterError("nothing to measure: name PCD files, or --simulate structured_light, stereo or ideal");
  return options;
}

void printHeading()
{
  std::printf("%-24s %6s %6s | %8s %8s %8s | %5s %5s %5s %5s | %5s %6s %6s | %6s\n", "cloud", "valid", "depth",
              "noise12", "noise32", "curved12", "r1", "r2", "r4", "r8", "gap", "closed", "mixed", "holes");
  std::printf("%-24s %6s %6s | %8s %8s %8s | %23s | %5s %6s %6s | %6s\n", "", "%", "m", "mm", "mm", "mm",
              "correlation at px", "px", "%", "/jump", "%");
}

/// The figures in the order and the units of the heading.
using Row = std::array<double, 13>;

Row rowOf(const NoiseFigures& f)
{
  return {100 * f.valid_share,  f.median_depth,   1e3 * f.small_tile_noise, 1e3 * f.large_tile_noise,
          1e3 * f.curved_noise, f.correlation[0], f.correlation[1],         f.correlation[2],
          f.correlation[3],     f.edge_gap,       100 * f.closed_edges,     f.mixed_pixels,
          100 * f.small_holes};
}

void print(const std::string& name, const Row& r)
{
  std::printf("%-24s %6.1f %6.3f | %8.3f %8.3f %8.3f | %5.2f %5.2f %5.2f %5.2f | %5.2f %6.1f %6.3f | %6.2f\n",
              name.c_str(), r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8], r[9], r[10], r[11], r[12]);
}

/// The middle of every column, without what a cloud could not tell.
void printMedian(const std::vector<Row>& rows)
{
  Row median;
  for (std::size_t column = 0; column < median.size(); ++column)
  {
    std::vector<double> values;
    for (const Row& row : rows)
      if (!std::isnan(row[column]))
        values.push_back(row[column]);
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    median[column] = n > 0 ? 0.5 * (values[(n - 1) / 2] + values[n / 2]) : std::numeric_limits<double>::quiet_NaN();
  }
  print("median of " + std::to_string(rows.size()), median);
}

void simulate(const Options& options)
{
  SensorParameters chosen;
  setParameter(visitor(chosen), "type", options.simulate);
  const SensorClass type = chosen.type;
  SensorParameters parameters = comparisonSensor(type);
  for (const std::string& assignment : options.overrides)
    setParameter(visitor(parameters), assignment);
  VirtualSensor sensor(parameters);
  std::vector<Row> rows;
  for (int k = 1; k <= options.scenes; ++k)
  {
    const auto seed = static_cast<std::uint32_t>(k);
    const Scan scan = sensor.scan(comparisonScene(type, seed), seed);
    const std::string name = options.simulate + "_" + std::to_string(k);
    rows.push_back(rowOf(noiseFigures(scan.grid)));
    print(name, rows.back());
    if (!options.save.empty())
      saveGrid(scan.grid, (std::filesystem::path(options.save) / (name + ".pcd")).string());
  }
  printMedian(rows);
}

void measureClouds(const std::vector<std::string>& clouds)
{
  std::vector<Row> rows;
  for (const std::string& cloud : clouds)
  {
    rows.push_back(rowOf(noiseFigures(loadGrid(cloud, InputParameters()))));
    print(std::filesystem::path(cloud).stem().string(), rows.back());
  }
  if (!rows.empty())
    printMedian(rows);
}
}  // namespace

int main(int argc, char** argv)
{
  try
  {
    const Options options = parseOptions(argc, argv);
    printHeading();
    measureClouds(options.clouds);
    if (!options.simulate.empty())
      simulate(options);
    return 0;
  }
  catch (const Error& error)
  {
    std::cerr << "benchmark_sensor_noise: " << error.what() << "\n";
    return 1;
  }
}
