// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "detector_options.hpp"

#include "terminal.hpp"

namespace bin_picking::tools
{
std::vector<Option> detectorOptions()
{
  return {
      {"--preset", "NAME", Values::One, "paper, fast or accurate (default fast)"},
      {"--config", "FILE.yaml", Values::One, "parameters that differ from the preset, under detector:"},
      {"--threads", "N", Values::One, "threads to use; 0: all processors (default)"},
      {"--set", "KEY=VALUE", Values::Assignments, "single parameters, last word; 'bin_picking parameters' lists them"}};
}

DetectorParameters detectorParameters(const Arguments& arguments)
{
  Configuration configuration;
  DetectorParameters& parameters = configuration.detector;
  parameters = DetectorParameters::preset(arguments.value("--preset", "fast"));
  applyConfigFile(arguments, configuration);
  if (arguments.has("--threads"))
    parameters.num_threads = parseInteger(arguments.value("--threads"), "--threads", 0, 1024);
  applyAssignments(arguments, visitor(parameters));
  return parameters;
}

void Configuration::visit(ParameterVisitor& v)
{
  v.group("training", training);
  v.group("detector", detector);
}

void applyConfigFile(const Arguments& arguments, Configuration& configuration)
{
  if (arguments.has("--config"))
    setParametersFromYaml(visitor(configuration), readText(arguments.value("--config")), arguments.value("--config"));
}

void applyAssignments(const Arguments& arguments, const VisitFunction& visit)
{
  for (const std::string& assignment : arguments.values("--set"))
    setParameter(visit, assignment);
}

std::vector<std::shared_ptr<const TrainedModel>> loadModels(const std::vector<std::string>& paths)
{
  std::vector<std::shared_ptr<const TrainedModel>> models;
  models.reserve(paths.size());
  for (const std::string& path : paths)
    models.push_back(loadModel(path));
  return models;
}
}  // namespace bin_picking::tools
