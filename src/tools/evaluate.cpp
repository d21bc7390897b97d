// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <filesystem>
#include <iostream>
#include <optional>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/detector.hpp"
#include "bin_picking_perception/evaluation/bop_results.hpp"
#include "bin_picking_perception/evaluation/evaluation_dataset.hpp"
#include "bin_picking_perception/evaluation/html_report.hpp"
#include "commands.hpp"
#include "detector_options.hpp"
#include "evaluation_models.hpp"
#include "evaluation_report.hpp"
#include "terminal.hpp"

namespace bin_picking::tools
{
namespace
{
namespace fs = std::filesystem;

constexpr int REPORT_FORMAT = 1;

std::string joined(const std::vector<std::string>& words)
{
  std::string text;
  for (const std::string& word : words)
    text += (text.empty() ? "" : " ") + word;
  return text;
}

EvaluationParameters evaluationParameters(const Arguments& arguments)
{
  EvaluationParameters parameters;
  if (arguments.has("--max-error"))
    setParameter(visitor(parameters), "max_error_share", arguments.value("--max-error"));
  if (arguments.has("--visible"))
    parameters.visible_levels = joined(arguments.values("--visible"));
  parameters.levels();  // complains now, and not after the detector has run
  return parameters;
}

DatasetSelection selection(const Arguments& arguments)
{
  return {arguments.value("--split"), arguments.values("--parts"),
          parseInteger(arguments.value("--max-scenes", "0"), "--max-scenes", 0, 1 << 30)};
}

/// Complains about a report that cannot be written before the detector has worked for it.
void requireFolders(const Arguments& arguments)
{
  for (const char* option : {"--json", "--csv", "--html"})
  {
    const fs::path folder = fs::path(arguments.value(option)).parent_path();
    std::error_code ignored;
    if (!folder.empty() && !fs::is_directory(folder, ignored))
      throw FileError("cannot write '" + arguments.value(option) + "': the folder '" + folder.string() +
                      "' does not exist; make it first");
  }
}

void requireFittingOptions(const Arguments& arguments)
{
  if (!arguments.has("--results"))
    return;
  for (const char* option : {"--model", "--cache", "--preset", "--config", "--set", "--repeat"})
    if (arguments.has(option))
      throw UsageError(std::string("option '") + option +
                       "' is for our detector, but --results says that another "
                       "program has found the poses; leave one of them away");
}

/// Where the poses come from: our detector, or the results of any program.
struct Source
{
  std::shared_ptr<const Detector> detector;
  ResultsOfScenes results;
};

Source openSource(const Arguments& arguments, const EvaluationDataset& dataset, const DetectorParameters& parameters,
                  Progress& progress)
{
  Source source;
  if (!arguments.has("--results"))
  {
    source.detector = std::make_shared<Detector>(modelsFor(dataset, arguments, progress), parameters);
    return source;
  }
  const std::string& path = arguments.value("--results");
  source.results = assignToScenes(loadBopResults(path), dataset, path);
  return source;
}

struct LoadedScan
{
  std::optional<pcl::PointCloud<pcl::PointXYZ>> cloud;  ///< a depth picture has none
  DepthGrid grid;
};

LoadedScan loadScan(const EvaluationScene& scene, const InputParameters& parameters)
{
  try
  {
    if (scene.depth_image)
      return {std::nullopt, loadSceneGrid(scene, parameters)};
    LoadedScan scan{loadSceneCloud(scene), {}};
    scan.grid = makeGrid(*scan.cloud, parameters);
    return scan;
  }
  catch (const CloudError& error)
  {
    throw FileError("The scan " + scene.file + " cannot be used. " + error.what());
  }
}

JudgedScene runDetector(const Detector& detector, const EvaluationScene& scene, const LoadedScan& scan,
                        const PartShapes& shapes, const EvaluationParameters& parameters, int repetitions)
{
  Detector::Request request;
  request.bin = scene.bin;
  request.parts = scene.parts;
  std::vector<RunTime> runs;
  std::vector<PoseEstimate> estimates;
  std::vector<TestedPose> tested;
  for (int k = 0; k < repetitions; ++k)
  {
    // The conversion of the cloud is part of the time.
    const DetectionResult result =
        scan.cloud ? detector.detect(*scan.cloud, request) : detector.detect(scan.grid, request);
    runs.push_back({result.total_seconds, result.timing, result.counts});
    estimates.clear();  // every run finds the same
    for (const Detection& detection : result.detections)
      estimates.push_back({detection.part, detection.T_camera_object, detection.score, detection.undetermined_turn});
    if (k == 0)
      tested = judgeTested(scene, result, shapes, parameters);
  }
  JudgedScene judged = judgeScene(scene, estimates, shapes, parameters);
  judged.tested = std::move(tested);
  judged.runs = runs;
  return judged;
}

JudgedScene judgeResults(const ResultsOfScenes& results, std::size_t k, const EvaluationScene& scene,
                         const PartShapes& shapes, const EvaluationParameters& parameters)
{
  JudgedScene judged = judgeScene(scene, results.estimates[k], shapes, parameters);
  if (results.seconds[k] >= 0)
    judged.runs.push_back({results.seconds[k], {}, {}});
  return judged;
}

std::vector<std::pair<std::string, std::string>> details(const Arguments& arguments)
{
  if (arguments.has("--results"))
    return {{"results", fs::path(arguments.value("--results")).filename().string()}};
  std::vector<std::pair<std::string, std::string>> all = {{"preset", arguments.value("--preset", "fast")}};
  if (arguments.has("--set"))
    all.emplace_back("set", joined(arguments.values("--set")));
  if (arguments.has("--split"))
    all.emplace_back("split", arguments.value("--split"));
  return all;
}

EvaluationReport evaluateScenes(const Arguments& arguments, EvaluationDataset& dataset)
{
  const DetectorParameters detector_parameters = detectorParameters(arguments);
  const int repetitions = parseInteger(arguments.value("--repeat", "1"), "--repeat", 1, 10000);
  EvaluationReport report;
  report.title = fs::canonical(dataset.path).filename().string();
  report.details = details(arguments);
  report.parameters = evaluationParameters(arguments);
  Progress progress;
  const PartShapes shapes = loadPartShapes(dataset, Executor(detector_parameters.num_threads));
  const Source source = openSource(arguments, dataset, detector_parameters, progress);
  for (std::size_t k = 0; k < dataset.scenes.size(); ++k)
  {
    EvaluationScene& scene = dataset.scenes[k];
    progress.show("scene " + std::to_string(k + 1) + " of " + std::to_string(dataset.scenes.size()) + ": " +
                  scene.name);
    const LoadedScan scan = loadScan(scene, detector_parameters.input);
    estimateVisibility(scene, scan.grid, shapes);
    report.scenes.push_back(source.detector
                                ? runDetector(*source.detector, scene, scan, shapes, report.parameters, repetitions)
                                : judgeResults(source.results, k, scene, shapes, report.parameters));
    if (arguments.has("--html"))
      report.pictures.push_back(drawScene(scan.grid, report.scenes.back(), shapes));
  }
  progress.finish();
  if (source.results.left_out > 0)
    std::cout << source.results.left_out << " results are of scenes or parts that are not searched for: left out\n";
  std::vector<std::string> parts;
  for (const EvaluationPart& part : dataset.parts)
    parts.push_back(part.definition.name);
  report.summary = summarize(report.scenes, parts, report.parameters);
  return report;
}

std::string jsonText(const Arguments& arguments, const EvaluationDataset& dataset, const EvaluationReport& report)
{
  nlohmann::json json = toJson(report.summary);
  json["format"] = REPORT_FORMAT;
  json["dataset"] = dataset.path;
  json["evaluation"] = {{"max_error_share", report.parameters.max_error_share},
                        {"visible_levels", report.parameters.levels()}};
  json["object_ids"] = nlohmann::json::object();
  for (const EvaluationPart& part : dataset.parts)
    json["object_ids"][part.definition.name] = part.object_id;
  if (arguments.has("--results"))
    json["results"] = arguments.value("--results");
  else
  {
    DetectorParameters parameters = detectorParameters(arguments);
    json["preset"] = arguments.value("--preset", "fast");
    for (const ParameterEntry& entry : listParameters(visitor(parameters)))
      json["detector"][entry.path] = entry.value;
  }
  json["scenes"] = nlohmann::json::array();
  for (const JudgedScene& scene : report.scenes)
    json["scenes"].push_back(toJson(scene));
  return json.dump(1) + "\n";
}

std::string csvText(const EvaluationDataset& dataset, const EvaluationReport& report)
{
  std::map<std::string, int> ids;
  for (const EvaluationPart& part : dataset.parts)
    ids[part.definition.name] = part.object_id;
  std::vector<BopResult> results;
  for (const JudgedScene& judged : report.scenes)
  {
    std::vector<double> totals;
    for (const RunTime& run : judged.runs)
      totals.push_back(run.total);
    const double seconds = totals.empty() ? -1 : spread(totals).median;
    for (const JudgedEstimate& e : judged.estimates)
      results.push_back({judged.scene.scene_id, judged.scene.image_id, ids.at(e.estimate.part), e.estimate.score,
                         e.estimate.T_camera_object, seconds});
  }
  return bopResultsCsv(results);
}

void evaluate(const Arguments& arguments)
{
  requireFittingOptions(arguments);
  requireFolders(arguments);
  evaluationParameters(arguments);
  EvaluationDataset dataset = openDataset(arguments.value("--dataset"), selection(arguments));
  const EvaluationReport report = evaluateScenes(arguments, dataset);
  std::cout << report.summary.all.scenes << " scenes, " << report.summary.all.instances << " parts in them, "
            << report.summary.all.precision.total << " poses returned\n\n";
  print(std::cout, report.summary);
  if (arguments.has("--json"))
    writeText(arguments.value("--json"), jsonText(arguments, dataset, report));
  if (arguments.has("--csv"))
    writeText(arguments.value("--csv"), csvText(dataset, report));
  if (arguments.has("--html"))
    writeText(arguments.value("--html"), htmlReport(report));
}
}  // namespace

Command evaluateCommand()
{
  Syntax syntax{
      "evaluate",
      "Holds the poses that are found in the scenes of a data set against the truth.",
      {},
      {{"--dataset", "DIR", Values::One, "scene folders with truth, or a data set of the BOP benchmark", true},
       {"--split", "NAME", Values::One, "split of a BOP data set (default: the only one)"},
       {"--parts", "NAME|DIR", Values::Many, "only these; a folder's part.yaml replaces the data set's"},
       {"--max-scenes", "N", Values::One, "only the first so many"},
       {"--model", "MODEL", Values::Many, "trained models (default: trained here, kept in the cache)"},
       {"--cache", "DIR", Values::One, "where trained models are kept (default: ~/.cache/bin_picking)"},
       {"--repeat", "N", Values::One, "runs per scene, for the times (default 1)"},
       {"--results", "FILE.csv", Values::One, "judge these poses (BOP results) in place of our detector's"},
       {"--max-error", "SHARE", Values::One, "of the diameter by which a right pose may be off (default 0.1)"},
       {"--visible", "SHARE", Values::Many, "visible fractions for the recall (default 0.5 0.85)"},
       {"--json", "FILE", Values::One, "write every figure, scene and pose, for programs"},
       {"--csv", "FILE.csv", Values::One, "write the poses as BOP results"},
       {"--html", "FILE.html", Values::One, "write one page with all figures and a picture of every scene"}},
      "evaluate --dataset bins --preset accurate --html report.html"};
  for (const Option& option : detectorOptions())
    syntax.options.push_back(option);
  return {syntax, evaluate};
}
}  // namespace bin_picking::tools
