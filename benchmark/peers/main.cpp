// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// OpenCV's and PCL's point-pair matching beside ours on the same scans: success, error, time, memory, growth, whole
// bins. One command, one report; benchmark/README.md says how to read it.
#include <algorithm>
#include <filesystem>
#include <iostream>

#include "arguments.hpp"
#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "child_process.hpp"
#include "report.hpp"
#include "terminal.hpp"
#include "views.hpp"

namespace fs = std::filesystem;
using namespace bin_picking;
using namespace bin_picking::peers;
using namespace bin_picking::tools;

namespace
{
/// How much is run.
struct Extent
{
  int views = 4;
  double step = 0.05;
  double limit = 60;
  std::vector<double> growth_steps = {0.14, 0.1, 0.07, 0.05};
  std::vector<int> growth_copies = {1, 2, 4, 8};
  double growth_copies_step = 0.08;
  int bin_scenes = 1;
  int bin_poses = 40;
  std::vector<std::size_t> programs;  // into peers::programs()
};

Syntax syntax()
{
  return {"",
          "Runs OpenCV's and PCL's point-pair matching beside ours on the same scans and prints one report.",
          {"PART_DIR..."},
          {{"--bins", "DATASET", Values::One, "also search for them in whole bins of this data set"},
           {"--scenes", "N", Values::One, "full bins per part of it (default 1)"},
           {"--views", "N", Values::One, "scans of each lone part (default 4)"},
           {"--programs", "NAME", Values::Many, "only these: ours, ours_on_points, opencv, pcl (default: all)"},
           {"--limit", "S", Values::One, "CPU seconds for a training or a scan (default 60)"},
           {"--no-growth", "", Values::None, "leave away the growth with the sizes of model and scene"},
           {"--quick", "", Values::None, "one view, coarse sampling, small sizes: about a minute; no figures to quote"},
           {"-o", "DIR", Values::One, "scans, report.md and report.json (default peers_report)"}},
          "config/parts/*/ --bins bins",
          "benchmark_peers"};
}

std::vector<std::size_t> selectedPrograms(const Arguments& arguments)
{
  std::vector<std::size_t> selected;
  std::vector<std::string> known;
  for (std::size_t p = 0; p < programs().size(); ++p)
  {
    known.push_back(programs()[p].key);
    if (!arguments.has("--programs"))
      selected.push_back(p);
  }
  if (arguments.has("--programs"))
    for (const std::string& key : arguments.values("--programs"))
    {
      const auto found = std::find(known.begin(), known.end(), key);
      if (found == known.end())
        throw UsageError("--programs is '" + key + "', but the programs are ours, ours_on_points, opencv and pcl");
      selected.push_back(static_cast<std::size_t>(found - known.begin()));
    }
  return selected;
}

Extent extentFor(const Arguments& arguments)
{
  Extent extent;
  extent.programs = selectedPrograms(arguments);
  if (arguments.has("--quick"))
  {
    extent.views = 1;
    extent.step = 0.08;
    extent.limit = 20;
    extent.growth_steps = {0.14, 0.1, 0.08};
    extent.growth_copies = {1, 2, 4};
    extent.growth_copies_step = 0.1;
  }
  const auto whole = [&](const char* option, int fallback, int high) {
    return parseInteger(arguments.value(option, std::to_string(fallback)), option, 1, high);
  };
  extent.views = whole("--views", extent.views, 1000);
  extent.bin_scenes = whole("--scenes", extent.bin_scenes, 1000);
  extent.limit = whole("--limit", static_cast<int>(extent.limit), 86400);
  return extent;
}

/// Scans are made in a process of their own: the sensor starts threads, which a process that forks must not have.
std::vector<EvaluationScene> scansOf(const std::function<std::vector<EvaluationScene>()>& make)
{
  std::vector<EvaluationScene> scenes;
  const std::string failure = runInChild(
      [&](const LineSink& emit) {
        for (const EvaluationScene& scene : make())
          emit(toJson(scene).dump());
      },
      600, [&](const std::string& line) { scenes.push_back(sceneFromJson(nlohmann::json::parse(line))); });
  if (!failure.empty())
    throw Error("the scans could not be made: " + failure);
  return scenes;
}

PlannedTrial runPlanned(Trial trial, const std::string& what, Progress& progress)
{
  progress.show(what + ": " + programs()[trial.program].name + ", " + trial.part.name);
  PlannedTrial planned;
  planned.outcome = runTrial(trial);
  planned.trial = std::move(trial);
  return planned;
}

void runLone(const PartDefinition& part, const Extent& extent, const std::string& folder, Study& study,
             Progress& progress)
{
  progress.show("scanning " + part.name);
  const auto scans = scansOf([&] { return makeViews(part, extent.views, 1, folder, part.name); });
  for (const std::size_t p : extent.programs)
    study.lone.push_back(
        runPlanned({p, part, programs()[p].own_step ? 0 : extent.step, scans, 1, extent.limit}, "one part", progress));
}

void runGrowth(const PartDefinition& part, const Extent& extent, const std::string& folder, Study& study,
               Progress& progress)
{
  progress.show("scanning groups of " + part.name);
  const auto view = scansOf([&] { return makeViews(part, 1, 2, folder, part.name + "_growth"); });
  const auto groups = scansOf([&] { return makeGroups(part, extent.growth_copies, 3, folder, part.name + "_group"); });
  for (const std::size_t p : extent.programs)
  {
    for (const double step : extent.growth_steps)
      study.model_growth.push_back(runPlanned({p, part, step, view, 1, extent.limit}, "growth", progress));
    study.scene_growth.push_back(
        runPlanned({p, part, extent.growth_copies_step, groups, 1, extent.limit}, "growth", progress));
  }
}

/// The first scenes in which several of the part lie, and of them only this part.
std::vector<EvaluationScene> fullBins(const EvaluationDataset& dataset, const std::string& part, int count)
{
  std::vector<EvaluationScene> scenes;
  for (EvaluationScene scene : dataset.scenes)
  {
    const auto other = [&](const TrueInstance& instance) { return instance.part != part; };
    scene.instances.erase(std::remove_if(scene.instances.begin(), scene.instances.end(), other), scene.instances.end());
    scene.parts = {part};
    if (scene.instances.size() > 1 && static_cast<int>(scenes.size()) < count)
      scenes.push_back(scene);
  }
  return scenes;
}

/// Why a program could not be trained for a part; what has failed once need not be waited for again.
std::string trainingFailure(const Study& study, std::size_t program, const std::string& part)
{
  for (const PlannedTrial& planned : study.lone)
    if (planned.trial.program == program && planned.trial.part.name == part && !planned.outcome.training)
      return planned.outcome.failure;
  return "";
}

void runBins(const EvaluationDataset& dataset, const Extent& extent, Study& study, Progress& progress)
{
  for (const EvaluationPart& part : dataset.parts)
    for (const std::size_t p : extent.programs)
    {
      if (programs()[p].key == "ours_on_points")
        continue;  // without the camera's grid it verifies nothing: it is for lone parts
      const Trial trial{p,
                        part.definition,
                        programs()[p].own_step ? 0 : extent.step,
                        fullBins(dataset, part.definition.name, extent.bin_scenes),
                        extent.bin_poses,
                        extent.limit};
      const std::string failure = trainingFailure(study, p, part.definition.name);
      study.bins.push_back(failure.empty() ? runPlanned(trial, "bins", progress)
                                           : PlannedTrial{trial, {{}, {}, failure}});
    }
}

void run(const Arguments& arguments, std::vector<std::string> command)
{
  const Extent extent = extentFor(arguments);
  const fs::path out = arguments.value("-o", "peers_report");
  const fs::path scans = out / "scans";
  fs::create_directories(scans);
  Study study;
  study.command = std::move(command);
  study.step = extent.step;
  study.limit = extent.limit;
  EvaluationDataset lone;
  std::vector<std::string> names;
  for (const std::string& folder : arguments.positionals())
  {
    lone.parts.push_back({loadPart(folder), static_cast<int>(lone.parts.size()) + 1, 0});
    names.push_back(lone.parts.back().definition.name);
  }
  const Executor executor(0);
  study.shapes = loadPartShapes(lone, executor);
  EvaluationDataset bins;
  if (arguments.has("--bins"))
    bins = openDataset(arguments.value("--bins"), {"", names, 0});
  study.bin_shapes = loadPartShapes(bins, executor);

  Progress progress;
  for (const EvaluationPart& part : lone.parts)
    runLone(part.definition, extent, scans.string(), study, progress);
  if (!arguments.has("--no-growth"))
    runGrowth(lone.parts.front().definition, extent, scans.string(), study, progress);
  runBins(bins, extent, study, progress);
  progress.finish();
  const std::string page = toMarkdown(study);
  writeText((out / "report.md").string(), page);
  writeText((out / "report.json").string(), toJson(study).dump(1) + "\n");
  std::cout << page;
}
}  // namespace

int main(int argc, char** argv)
{
  const std::vector<std::string> words(argv + 1, argv + argc);
  try
  {
    if (std::find(words.begin(), words.end(), "--help") != words.end())
    {
      std::cout << helpText(syntax());
      return 0;
    }
    std::vector<std::string> command(argv, argv + argc);
    command.front() = fs::path(command.front()).filename().string();
    run(Arguments(syntax(), words), command);
    return 0;
  }
  catch (const UsageError& error)
  {
    std::cerr << error.what() << "\n";
    return 2;
  }
  catch (const std::exception& error)
  {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
