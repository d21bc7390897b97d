// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// Empties virtual bins: scan, detect, plan, grip, judged by the true geometry. benchmark/README.md says how to read it.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <optional>

#include "arguments.hpp"
#include "bin_picking_perception/common/error.hpp"
#include "detector_options.hpp"
#include "report.hpp"
#include "terminal.hpp"

namespace fs = std::filesystem;
using namespace bin_picking;
using namespace bin_picking::picking;
using namespace bin_picking::tools;
using simulation::CellParameters;
using simulation::CellPart;
using simulation::VirtualCell;

namespace
{
// As in launch/demo.launch: the bin is level, 0.5 m in front of the base and 0.1 m above it.
const Pose T_BASE_LINK_CAMERA = Eigen::Translation3d(0.5, 0.1116, 0.8922) *
                                Eigen::Quaterniond(0.069943, 0.997551, 0, 0).normalized();  // w, x, y, z

Syntax syntax()
{
  return {"",
          "Fills virtual bins and empties them grasp by grasp; reports successes and the causes of failures.",
          {"PART_DIR..."},
          {{"--gripper", "FILE.yaml", Values::One, "the mounted gripper", true},
           {"--robot", "FILE.yaml", Values::One, "only grasps that this robot reaches (default: all)"},
           {"--mixed", "", Values::None, "all parts in one bin (default: bins of one kind, kind after kind)"},
           {"--count", "N", Values::One, "parts of each kind in a bin (default 25)"},
           {"--seeds", "A..B", Values::One, "one bin for each (default 1..4)"},
           {"--picks", "N", Values::One, "stop a kind after so many attempts (default: when all its bins are done)"},
           {"--failures", "N", Values::One, "give up a bin after so many failures in a row (default 10)"},
           {"--sensor", "NAME", Values::One, "structured_light (default), stereo or ideal"},
           {"--preset", "NAME", Values::One, "of the detector: paper, fast (default) or accurate"},
           {"--no-shake", "", Values::None, "leave what cannot be taken (default: shake the bin and go on)"},
           {"--truth", "", Values::None, "true poses in place of detections: only grasp planning can fail"},
           {"--threads", "N", Values::One, "0: all processors (default)"},
           {"--models", "DIR", Values::One, "trained models are kept there (default picking_models)"},
           {"--json", "FILE", Values::One, "every attempt"},
           {"--version", "TEXT", Values::One, "noted in the report: $(git describe --always --dirty)"},
           {"--set", "KEY=VALUE", Values::Assignments,
            "parameters of the grasps: max_tilt, obstacles/part_clearance, ..."}},
          "config/parts/three_way_tube --gripper config/grippers/ag95.yaml --seeds 1..4",
          "benchmark_picking"};
}

struct Range
{
  int first = 1;
  int last = 4;
};

Range seedsOf(const Arguments& arguments)
{
  const std::string text = arguments.value("--seeds", "1..4");
  const auto dots = text.find("..");
  const int first = parseInteger(text.substr(0, dots), "--seeds", 0, 1000000);
  return {first, dots == std::string::npos ? first : parseInteger(text.substr(dots + 2), "--seeds", first, 1000000)};
}

/// What is the same for all bins.
struct Bench
{
  DetectorParameters detector;
  CellParameters cell;
  EmptyingSettings settings;
  GraspParameters grasps;
  Gripper gripper;
  std::optional<Robot> robot;
  std::string models;
  Range seeds;
  int count = 25;
  int picks = 0;
  int threads = 0;
};

Bench benchFrom(const Arguments& arguments)
{
  Bench bench;
  bench.threads = parseInteger(arguments.value("--threads", "0"), "--threads", 0, 1024);
  bench.detector = DetectorParameters::preset(arguments.value("--preset", "fast"));
  bench.detector.num_threads = bench.threads;
  if (arguments.has("--sensor"))
    setParameter(visitor(bench.cell), "sensor/type", arguments.value("--sensor"));
  if (arguments.has("--set"))
    applyAssignments(arguments, visitor(bench.grasps));
  bench.settings.truth = arguments.has("--truth");
  bench.settings.shake = !arguments.has("--no-shake");
  bench.settings.max_failures = parseInteger(arguments.value("--failures", "10"), "--failures", 1, 1000000);
  bench.gripper = loadGripper(arguments.value("--gripper"));
  if (arguments.has("--robot"))
    bench.robot = loadRobot(arguments.value("--robot"));
  bench.models = arguments.value("--models", "picking_models");
  bench.seeds = seedsOf(arguments);
  bench.count =
      parseInteger(arguments.value("--count", "25"), "--count", 1, static_cast<int>(simulation::MAX_CELL_PARTS));
  bench.picks = parseInteger(arguments.value("--picks", "0"), "--picks", 0, 1000000);
  return bench;
}

std::shared_ptr<const TrainedModel> modelOf(const PartDefinition& part, const Bench& bench, Progress& progress)
{
  progress.show("training " + part.name);
  fs::create_directories(bench.models);
  std::string note;
  return loadOrTrain(part, TrainingParameters{}, (fs::path(bench.models) / (part.name + ".model")).string(),
                     Executor(bench.threads), note);
}

/// One line, so that a long run can be followed.
std::string summary(const Emptying& bin)
{
  const auto taken = std::count_if(bin.attempts.begin(), bin.attempts.end(),
                                   [](const Attempt& attempt) { return attempt.succeeded(); });
  return std::to_string(taken) + " of " + std::to_string(bin.filled) + " parts taken in " +
         std::to_string(bin.attempts.size()) + " attempts";
}

/// All bins with these parts in them.
PartStudy emptyBins(const std::string& name, const std::vector<PartDefinition>& parts, const Bench& bench,
                    Progress& progress)
{
  std::vector<std::shared_ptr<const TrainedModel>> models;
  std::vector<CellPart> cell_parts;
  for (const PartDefinition& part : parts)
  {
    models.push_back(modelOf(part, bench, progress));
    cell_parts.push_back({part.name, std::make_shared<const TriangleMesh>(loadMesh(part.mesh_file, part.mesh_unit))});
  }
  const Detector detector(models, bench.detector);
  const GraspPlanner planner({parts, bench.gripper, bench.robot, bench.grasps, bench.threads});
  const Pose T_base_camera =
      bench.robot ? bench.robot->T_base_link_base.inverse() * T_BASE_LINK_CAMERA : T_BASE_LINK_CAMERA;
  VirtualCell cell(cell_parts, bench.cell, bench.threads);
  PartStudy study;
  study.name = name;
  int attempts = 0;
  for (int seed = bench.seeds.first; seed <= bench.seeds.last && (bench.picks == 0 || attempts < bench.picks); ++seed)
  {
    EmptyingSettings settings = bench.settings;
    settings.max_picks = bench.picks == 0 ? 0 : bench.picks - attempts;
    progress.show(name + ": bin " + std::to_string(seed) + ", " + std::to_string(attempts) + " picks so far");
    study.bins.push_back(emptyBin(cell, std::vector<int>(parts.size(), bench.count), static_cast<std::uint32_t>(seed),
                                  {detector, planner, T_base_camera, settings}));
    attempts += static_cast<int>(study.bins.back().attempts.size());
    progress.finish();
    std::cerr << name << ", bin " << seed << ": " << summary(study.bins.back()) << "\n";
  }
  return study;
}

void run(const Arguments& arguments, std::vector<std::string> command)
{
  const Bench bench = benchFrom(arguments);
  std::vector<PartDefinition> parts;
  for (const std::string& folder : arguments.positionals())
    parts.push_back(loadPart(folder));
  Study study;
  study.command = std::move(command);
  study.version = arguments.value("--version", "");
  study.sensor = arguments.value("--sensor", "structured_light");
  study.gripper = bench.gripper.name;
  study.truth = bench.settings.truth;
  Progress progress;
  if (arguments.has("--mixed"))
    study.parts.push_back(emptyBins("mixed", parts, bench, progress));
  else
    for (const PartDefinition& part : parts)
      study.parts.push_back(emptyBins(part.name, {part}, bench, progress));
  progress.finish();
  if (arguments.has("--json"))
    writeText(arguments.value("--json"), toJson(study));
  std::cout << toText(study);
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
