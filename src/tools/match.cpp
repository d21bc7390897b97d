// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <iostream>

#include "bin_picking_perception/detector.hpp"
#include "commands.hpp"
#include "detector_options.hpp"
#include "report.hpp"
#include "terminal.hpp"

namespace bin_picking::tools
{
namespace
{
void match(const Arguments& arguments)
{
  const DetectorParameters parameters = detectorParameters(arguments);
  const LengthUnit unit = parseLengthUnit(arguments.value("--unit"));
  Progress progress;
  progress.show("loading");
  const Stopwatch model_watch;
  const auto models = loadModels({arguments.value("--model")});
  const double model_seconds = model_watch.seconds();
  const Stopwatch points_watch;
  const OrientedPoints scene = loadOrientedPoints(arguments.value("--points"), unit);
  const double points_seconds = points_watch.seconds();
  progress.show("matching");
  const DetectionResult result = Detector(models, parameters).match(scene, arguments.has("--scene-is-part"));
  progress.finish();
  print(std::cout, result);
  if (!arguments.has("--json"))
    return;
  nlohmann::json json = toJson(result);
  json["points"] = arguments.value("--points");
  json["models"] = arguments.values("--model");
  json["loading_ms"] = {{"models", model_seconds * 1000}, {"points", points_seconds * 1000}};
  writeText(arguments.value("--json"), json.dump(1) + "\n");
}
}  // namespace

Command matchCommand()
{
  Syntax syntax{"match",
                "Finds one part in a set of points with normals, such as a whole scan; no camera, no segmentation.",
                {},
                {{"--model", "MODEL", Values::One, "trained model of the part", true},
                 {"--points", "FILE.ply", Values::One, "points with normals (x y z nx ny nz)", true},
                 {"--unit", "UNIT", Values::One, "unit of the points: m, cm, mm or inch", true},
                 {"--scene-is-part", "", Values::None, "all points belong to the part: all count in the matching rate"},
                 {"--json", "FILE", Values::One, "write everything that was found, for programs"}},
                "match --model tube.model --points scan.ply --unit mm --preset paper"};
  for (const Option& option : detectorOptions())
    syntax.options.push_back(option);
  return {syntax, match};
}
}  // namespace bin_picking::tools
