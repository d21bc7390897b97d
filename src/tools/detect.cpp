// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <iostream>

#include "bin_picking_perception/detector.hpp"
#include "bin_picking_perception/evaluation/detection_picture.hpp"
#include "bin_picking_perception/scene/cloud_input.hpp"
#include "commands.hpp"
#include "detector_options.hpp"
#include "report.hpp"
#include "terminal.hpp"

namespace bin_picking::tools
{
namespace
{
void writeJson(const Arguments& arguments, const DetectionResult& result, double models_seconds, double cloud_seconds)
{
  nlohmann::json json = toJson(result);
  json["cloud"] = arguments.value("--cloud");
  json["models"] = arguments.values("--model");
  json["loading_ms"] = {{"models", models_seconds * 1000}, {"cloud", cloud_seconds * 1000}};
  writeText(arguments.value("--json"), json.dump(1) + "\n");
}

void detect(const Arguments& arguments)
{
  const DetectorParameters parameters = detectorParameters(arguments);
  Progress progress;
  progress.show("loading");
  const Stopwatch models_watch;
  const auto models = loadModels(arguments.values("--model"));
  const double models_seconds = models_watch.seconds();
  Detector::Request request;
  if (arguments.has("--bin"))
    request.bin = loadBin(arguments.value("--bin"));
  const Stopwatch cloud_watch;
  const pcl::PointCloud<pcl::PointXYZ> cloud = loadCloud(arguments.value("--cloud"));
  const double cloud_seconds = cloud_watch.seconds();
  progress.show("detecting");
  const DetectionResult result = Detector(models, parameters).detect(cloud, request);
  progress.finish();
  print(std::cout, result);
  if (arguments.has("--json"))
    writeJson(arguments, result, models_seconds, cloud_seconds);
  if (arguments.has("--image"))
    saveDetectionPicture(makeGrid(cloud, parameters.input), result, models, arguments.value("--image"));
}
}  // namespace

Command detectCommand()
{
  Syntax syntax{"detect",
                "Finds parts in an organized point cloud: poses, scores and why others were rejected.",
                {},
                {{"--model", "MODEL", Values::Many, "trained models of the parts to look for", true},
                 {"--cloud", "FILE.pcd", Values::One, "organized cloud, metres, camera optical frame", true},
                 {"--bin", "BIN.yaml", Values::One, "pose and inner size of the bin (default: the whole cloud)"},
                 {"--json", "FILE", Values::One, "write everything that was found, for programs"},
                 {"--image", "FILE.png", Values::One, "write the depth picture with the parts drawn over it"}},
                "detect --model tube.model --cloud scene/scene.pcd --bin scene/bin.yaml --json found.json"};
  for (const Option& option : detectorOptions())
    syntax.options.push_back(option);
  return {syntax, detect};
}
}  // namespace bin_picking::tools
