// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/common/parameters.hpp"

#include <iostream>

#include "bin_picking_perception/detector_parameters.hpp"
#include "bin_picking_perception/grasping/grasp_check.hpp"
#include "bin_picking_perception/model/training_parameters.hpp"
#include "bin_picking_perception/robot/reach.hpp"
#include "commands.hpp"
#include "virtual_cell.hpp"

namespace bin_picking::tools
{
namespace
{
/// The table lists what --set takes; the YAML what --config reads, where each command has a group of its own.
template <typename Parameters>
void print(const Arguments& arguments, const std::string& group, Parameters& parameters)
{
  if (arguments.has("--markdown"))
    std::cout << toMarkdown(visitor(parameters));
  else
    std::cout << toYaml([&](ParameterVisitor& v) { v.group(group, parameters); });
}

void parameters(const Arguments& arguments)
{
  const std::string command = arguments.value("--of", "detect");
  if (command != "detect" && arguments.has("--preset"))
    throw UsageError("--preset goes with the parameters of detect; those of " + command + " have none");
  DetectorParameters detector = DetectorParameters::preset(arguments.value("--preset", "fast"));
  TrainingParameters training;
  simulation::CellParameters cell;
  GraspCheckParameters grasps;
  ReachParameters reach;
  if (command == "detect")
    print(arguments, "detector", detector);
  else if (command == "train")
    print(arguments, "training", training);
  else if (command == "simulate")
    print(arguments, "simulate", cell);
  else if (command == "grasps")
    print(arguments, "grasps", grasps);
  else if (command == "reach")
    print(arguments, "reach", reach);
  else
    throw UsageError("--of is '" + command + "', but it must be one of: detect, train, simulate, grasps, reach");
}
}  // namespace

Command parametersCommand()
{
  return {{"parameters",
           "Lists every parameter with its value, unit, range and effect; as YAML that --config reads, or as a table.",
           {},
           {{"--preset", "NAME", Values::One, "paper, fast or accurate (default fast)"},
            {"--of", "COMMAND", Values::One, "detect (default), train, simulate, grasps or reach"},
            {"--markdown", "", Values::None, "a Markdown table in place of YAML"}},
           "parameters --preset accurate > accurate.yaml"},
          parameters};
}
}  // namespace bin_picking::tools
