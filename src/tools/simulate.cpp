// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <numeric>
#include <set>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/part.hpp"
#include "commands.hpp"
#include "detector_options.hpp"
#include "output_folder.hpp"
#include "scene_files.hpp"
#include "terminal.hpp"
#include "virtual_cell.hpp"

namespace bin_picking::tools
{
namespace
{
namespace fs = std::filesystem;
using simulation::CellParameters;
using simulation::CellScan;
using simulation::VirtualCell;

constexpr int DEFAULT_COUNT = 25;
constexpr int MAX_COUNT = 60;

CellParameters cellParameters(const Arguments& arguments)
{
  CellParameters parameters;
  if (arguments.has("--sensor"))
    setParameter(visitor(parameters), "sensor/type", arguments.value("--sensor"));
  if (arguments.has("--size"))
  {
    const std::string& size = arguments.value("--size");
    const auto cross = size.find('x');
    if (cross == std::string::npos)
      throw UsageError("--size is '" + size + "', but it must be WIDTHxHEIGHT in pixels, for example 1280x1024");
    setParameter(visitor(parameters), "sensor/width", size.substr(0, cross));
    setParameter(visitor(parameters), "sensor/height", size.substr(cross + 1));
  }
  applyAssignments(arguments, visitor(parameters));
  return parameters;
}

std::vector<PartDefinition> loadParts(const Arguments& arguments)
{
  std::vector<PartDefinition> parts;
  std::set<std::string> names;
  for (const std::string& path : arguments.positionals())
  {
    parts.push_back(loadPart(path));
    if (!names.insert(parts.back().name).second)
      throw UsageError("the part '" + parts.back().name + "' was given twice; parts are told apart by name");
  }
  return parts;
}

std::vector<simulation::CellPart> cellParts(const std::vector<PartDefinition>& definitions)
{
  std::vector<simulation::CellPart> parts;
  for (const PartDefinition& definition : definitions)
    parts.push_back(
        {definition.name, std::make_shared<TriangleMesh>(loadMesh(definition.mesh_file, definition.mesh_unit))});
  return parts;
}

/// One number for all kinds together is shared out evenly, the first kinds taking what is left over.
std::vector<int> countsOf(const Arguments& arguments, std::size_t kinds)
{
  std::vector<int> counts;
  if (arguments.has("--empty"))
  {
    if (arguments.has("--count"))
      throw UsageError("--empty and --count exclude each other; keep one of them");
    return std::vector<int>(kinds, 0);
  }
  for (const std::string& text : arguments.values("--count"))
    counts.push_back(parseInteger(text, "--count", counts.empty() && kinds == 1 ? 1 : 0, MAX_COUNT));
  if (counts.size() == kinds && kinds > 1)
    return counts;
  if (counts.size() > 1)
    throw UsageError("--count has " + std::to_string(counts.size()) + " numbers for " + std::to_string(kinds) +
                     " parts; give one number in all, or one for each part");
  const int total = counts.empty() ? DEFAULT_COUNT : counts[0];
  std::vector<int> shared(kinds, total / static_cast<int>(kinds));
  for (std::size_t k = 0; k < static_cast<std::size_t>(total) % kinds; ++k)
    ++shared[k];
  return shared;
}

/// So that the data set can be evaluated without anything else.
void copyParts(const std::vector<PartDefinition>& parts, const fs::path& folder)
{
  for (const PartDefinition& part : parts)
  {
    const fs::path target = folder / "parts" / part.name;
    const fs::path mesh = fs::relative(part.mesh_file, part.directory);
    fs::create_directories((target / mesh).parent_path());
    fs::copy_file(fs::path(part.directory) / "part.yaml", target / "part.yaml");
    fs::copy_file(part.mesh_file, target / mesh);
  }
}

std::string sceneName(int number)
{
  char name[32];
  std::snprintf(name, sizeof(name), "scene_%04d", number);
  return name;
}

void report(const CellScan& scan, const VirtualCell& cell, const std::string& name, double seconds)
{
  const auto visible = std::count_if(scan.instances.begin(), scan.instances.end(),
                                     [](const auto& instance) { return instance.view.visible_fraction >= 0.5; });
  const DepthGrid& grid = scan.scan.grid;
  const auto valid = std::count_if(grid.z.begin(), grid.z.end(), [](float z) { return z == z; });
  std::cout << name << ": " << scan.instances.size() << " parts, " << visible << " at least half visible, deepest overlap "
            << fixed(1000 * cell.deepestOverlap().depth, 2) << " mm, "
            << fixed(100.0 * static_cast<double>(valid) / static_cast<double>(grid.size()), 1)
            << " % of the pixels measured, " << fixed(seconds, 1) << " s\n";
}

void simulate(const Arguments& arguments)
{
  const CellParameters parameters = cellParameters(arguments);
  const std::vector<PartDefinition> parts = loadParts(arguments);
  const std::vector<int> counts = countsOf(arguments, parts.size());
  const int seed = parseInteger(arguments.value("--seed", "1"), "--seed", 0, 2147483647 - 100000);
  const int scenes = parseInteger(arguments.value("--scenes", "1"), "--scenes", 1, 100000);
  OutputFolder output(arguments.value("-o"), {"scene.pcd", "scene_0001/scene.pcd"});
  Progress progress;
  progress.show("preparing the parts");
  VirtualCell cell(cellParts(parts), parameters, parseInteger(arguments.value("--threads", "0"), "--threads", 0, 256));
  copyParts(parts, output.path());
  for (int k = 0; k < scenes; ++k)
  {
    const Stopwatch watch;
    const std::string name = sceneName(k + 1);
    const auto scene_seed = static_cast<std::uint32_t>(seed + k);
    cell.clear();
    if (std::accumulate(counts.begin(), counts.end(), 0) > 0)
      cell.fill(counts, scene_seed, [&](double share) {
        progress.show(name + ": dropping parts, " + fixed(100 * share, 0) + " %");
      });
    progress.show(name + ": measuring");
    const CellScan scan = cell.scan(scene_seed);
    const fs::path folder = scenes == 1 ? output.path() : output.path() / name;
    fs::create_directories(folder);
    writeScene(scan, cell, scene_seed, folder.string());
    progress.finish();
    report(scan, cell, scenes == 1 ? arguments.value("-o") : name, watch.seconds());
  }
  output.publish();
}
}  // namespace

Command simulateCommand()
{
  return {{"simulate",
           "Drops parts into a virtual bin and measures it with a virtual 3D sensor: clouds with the true poses.",
           {"PART_DIR..."},
           {{"--count", "N", Values::Many, "number of parts in all, or of each kind (default 25, at most 60)"},
            {"--empty", "", Values::None, "no parts: what the sensor sees of the bin alone"},
            {"--seed", "N", Values::One, "another number gives another pile and other noise (default 1)"},
            {"--scenes", "N", Values::One, "so many scenes, seeds counting up (default 1)"},
            {"--sensor", "NAME", Values::One, "structured_light (default), stereo or ideal"},
            {"--size", "WIDTHxHEIGHT", Values::One, "pixels of the camera (default 1280x1024)"},
            {"--threads", "N", Values::One, "0: all processors (default); the result is the same"},
            {"--set", "KEY=VALUE", Values::Assignments, "single parameters; 'bin_picking parameters --of simulate'"},
            {"-o", "DIR", Values::One, "folder to write to; an earlier data set there is replaced", true}},
           "simulate config/parts/three_way_tube --count 25 -o scene"},
          simulate};
}
}  // namespace bin_picking::tools
