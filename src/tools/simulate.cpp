// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <numeric>
#include <set>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/figures.hpp"
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
constexpr int MAX_COUNT = simulation::MAX_CELL_PARTS;

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
    const std::string& name = parts.back().name;
    if (fs::path(name).filename() != name || name == "." || name == "..")
      throw FileError("the part's name '" + name + "' cannot be that of a folder; change it in '" +
                      parts.back().files.front() + "'");
    if (!names.insert(name).second)
      throw UsageError("the part '" + name + "' was given twice; parts are told apart by name");
  }
  return parts;
}

std::vector<simulation::CellPart> cellParts(const std::vector<PartDefinition>& definitions)
{
  std::vector<simulation::CellPart> parts;
  for (const PartDefinition& definition : definitions)
  {
    auto mesh = std::make_shared<const TriangleMesh>(loadMesh(definition.mesh_file, definition.mesh_unit));
    checkExpectedSize(definition, inspectMesh(*mesh).size);
    parts.push_back({definition.name, std::move(mesh)});
  }
  return parts;
}

/// One number for all kinds together is shared out evenly, the first kinds taking what is left over.
std::vector<int> sharedOut(int total, std::size_t kinds)
{
  std::vector<int> counts(kinds, total / static_cast<int>(kinds));
  for (std::size_t k = 0; k < static_cast<std::size_t>(total) % kinds; ++k)
    ++counts[k];
  return counts;
}

std::vector<int> countsOf(const Arguments& arguments, std::size_t kinds)
{
  if (arguments.has("--empty") && arguments.has("--count"))
    throw UsageError("--empty and --count exclude each other; keep one of them");
  if (arguments.has("--empty"))
    return std::vector<int>(kinds, 0);
  if (!arguments.has("--count"))
    return sharedOut(DEFAULT_COUNT, kinds);
  std::vector<int> counts;
  for (const std::string& text : arguments.values("--count"))
    counts.push_back(parseInteger(text, "--count", 0, MAX_COUNT));
  if (counts.size() != 1 && counts.size() != kinds)
    throw UsageError("--count has " + std::to_string(counts.size()) + " numbers for " + std::to_string(kinds) +
                     (kinds == 1 ? " part" : " parts") + "; give one number in all, or one for each part");
  const int total = std::accumulate(counts.begin(), counts.end(), 0);
  if (total < 1 || total > MAX_COUNT)
    throw UsageError("--count asks for " + std::to_string(total) + " parts in all, but it must lie in [1, " +
                     std::to_string(MAX_COUNT) + "]; --empty leaves the bin empty");
  return counts.size() == 1 ? sharedOut(total, kinds) : counts;
}

/// So that the data set can be evaluated without anything else.
void copyParts(const std::vector<PartDefinition>& parts, const fs::path& folder)
{
  for (const PartDefinition& part : parts)
  {
    const fs::path source = fs::absolute(part.directory).lexically_normal();
    for (const std::string& file : part.files)
    {
      const fs::path inside = fs::absolute(file).lexically_normal().lexically_relative(source);
      if (*inside.begin() == "..")
        throw FileError("'" + file + "' lies outside the folder of the part '" + part.name +
                        "', so that the data set cannot hold a copy of it; move it into '" + part.directory + "'");
      const fs::path name = file == part.files.front() ? "part.yaml" : inside;
      const fs::path target = folder / "parts" / part.name / name;
      fs::create_directories(target.parent_path());
      fs::copy_file(file, target, fs::copy_options::overwrite_existing);
    }
  }
}

/// Whether a folder holds what this command writes, and nothing else.
bool isOurs(const fs::path& folder)
{
  const std::set<std::string> known = {"scene.pcd", "bin.yaml", "camera.json", "truth.json", "scene.png", "parts"};
  const std::string scene = "scene_";
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
  {
    const std::string name = entry.path().filename().string();
    if (known.count(name) == 0 && name.compare(0, scene.size(), scene) != 0)
      return false;
  }
  return simulation::holdsVirtualScene(folder.string()) ||
         simulation::holdsVirtualScene((folder / "scene_0001").string());
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
  const auto valid = std::count_if(grid.z.begin(), grid.z.end(), [](float z) { return std::isfinite(z); });
  std::cout << name << ": " << scan.instances.size() << " parts, " << visible
            << " at least half visible, deepest overlap " << roundedText(1000 * cell.deepestOverlap().depth, 2)
            << " mm, " << roundedText(100.0 * static_cast<double>(valid) / static_cast<double>(grid.size()), 1)
            << " % of the pixels measured, " << roundedText(seconds, 1) << " s\n";
}

void simulate(const Arguments& arguments)
{
  const CellParameters parameters = cellParameters(arguments);
  const std::vector<PartDefinition> parts = loadParts(arguments);
  const std::vector<int> counts = countsOf(arguments, parts.size());
  const int seed = parseInteger(arguments.value("--seed", "1"), "--seed", 0, 2147483647 - 100000);
  const int scenes = parseInteger(arguments.value("--scenes", "1"), "--scenes", 1, 100000);
  OutputFolder output(arguments.value("-o"), isOurs);
  copyParts(parts, output.path());
  Progress progress;
  progress.show("preparing the parts");
  VirtualCell cell(cellParts(parts), parameters, parseInteger(arguments.value("--threads", "0"), "--threads", 0, 256));
  for (int k = 0; k < scenes; ++k)
  {
    const Stopwatch watch;
    const std::string name = sceneName(k + 1);
    const auto scene_seed = static_cast<std::uint32_t>(seed + k);
    cell.clear();
    if (std::accumulate(counts.begin(), counts.end(), 0) > 0)
      cell.fill(counts, scene_seed,
                [&](double share) { progress.show(name + ": dropping parts, " + roundedText(100 * share, 0) + " %"); });
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
