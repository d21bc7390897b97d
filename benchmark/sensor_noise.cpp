// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
//
// What organized clouds tell about the noise, the losses and the edges of their sensor, real and virtual by the same
// measure: one line per cloud.
// Usage: benchmark_sensor_noise [CLOUD.pcd ...] [--simulate structured_light|stereo|ideal] [--set parameter=value ...]
//                               [--scenes N] [--save FOLDER]
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
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
  int scenes = 3;
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
      options.scenes = std::atoi(value.c_str());
    else if (word == "--save")
      options.save = value;
    else
      throw ParameterError("unknown option '" + word + "'; known are --simulate, --set, --scenes and --save");
  }
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

void print(const std::string& name, const DepthGrid& grid)
{
  const NoiseFigures f = noiseFigures(grid);
  std::printf("%-24s %6.1f %6.3f | %8.3f %8.3f %8.3f | %5.2f %5.2f %5.2f %5.2f | %5.2f %6.1f %6.3f | %6.2f\n",
              name.c_str(), 100 * f.valid_share, f.median_depth, 1e3 * f.small_tile_noise, 1e3 * f.large_tile_noise,
              1e3 * f.curved_noise, f.correlation[0], f.correlation[1], f.correlation[2], f.correlation[3], f.edge_gap,
              100 * f.closed_edges, f.mixed_pixels, 100 * f.small_holes);
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
  for (int k = 1; k <= options.scenes; ++k)
  {
    const auto seed = static_cast<std::uint32_t>(k);
    const Scan scan = sensor.scan(comparisonScene(type, seed), seed);
    const std::string name = options.simulate + "_" + std::to_string(k);
    print(name, scan.grid);
    if (!options.save.empty())
      saveGrid(scan.grid, (std::filesystem::path(options.save) / (name + ".pcd")).string());
  }
}
}  // namespace

int main(int argc, char** argv)
{
  try
  {
    const Options options = parseOptions(argc, argv);
    printHeading();
    for (const std::string& cloud : options.clouds)
      print(std::filesystem::path(cloud).stem().string(), loadGrid(cloud, InputParameters()));
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
