// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "method.hpp"

#include <yaml-cpp/yaml.h>
#include <ctime>
#include <filesystem>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking::paper
{
namespace
{
YAML::Node loadYaml(const std::string& file)
{
  try
  {
    return YAML::LoadFile(file);
  }
  catch (const YAML::Exception& error)
  {
    throw FileError("The configuration " + file + " cannot be read (" + error.what() + "); check its name.");
  }
}

void assign(const VisitFunction& visit, const Json& values)
{
  for (const auto& [key, value] : values.items())
    setParameter(visit, key, value.is_string() ? value.get<std::string>() : value.dump());
}
/// One file per part, mesh and parameters.
std::string modelFile(const std::string& folder, const PartDefinition& part, const TrainingParameters& training)
{
  std::filesystem::create_directories(folder);
  const std::uint64_t hash = requestHash(part, training) ^ hashFile(part.mesh_file);
  return (std::filesystem::path(folder) / (part.name + "-" + std::to_string(hash) + ".model")).string();
}
}  // namespace

Method readMethod(const Json& json)
{
  Method method;
  method.name = json.at("name").get<std::string>();
  method.detector = DetectorParameters::preset(json.value("preset", "paper"));
  if (const std::string config = json.value("config", ""); !config.empty())
  {
    const YAML::Node root = loadYaml(config);
    setParametersFromYaml(visitor(method.training), YAML::Dump(root["training"]), config);
    setParametersFromYaml(visitor(method.detector), YAML::Dump(root["detector"]), config);
  }
  assign(visitor(method.training), json.value("training", Json::object()));
  assign(visitor(method.detector), json.value("detector", Json::object()));
  method.part_training = json.value("part_training", false);
  method.true_segments = json.value("segments", "") == "true";
  return method;
}

std::shared_ptr<const TrainedModel> Models::get(const PartDefinition& part, const Method& method)
{
  PartDefinition definition = part;
  if (!method.part_training)
    definition.training_yaml.clear();
  TrainingParameters training = method.training;
  const std::string key = part.mesh_file + definition.training_yaml + toYaml(visitor(training));
  auto& model = models_[key];
  if (!model && folder_.empty())
    model = trainPart(definition, training, executor_);
  if (!model)
  {
    std::string note;
    model = loadOrTrain(definition, training, modelFile(folder_, definition, training), executor_, note);
  }
  return model;
}

Json describe(const TrainedModel& model)
{
  std::size_t low = 0;
  std::size_t high = 0;
  for (const float q : model.points.curvature)
  {
    const int kind = model.classes.classOf(q);
    low += kind < 0 ? 1 : 0;
    high += kind > 0 ? 1 : 0;
  }
  const auto count = static_cast<double>(model.points.size());
  return {{"points", model.points.size()},
          {"pairs", model.table.numEntries()},
          {"curvature_bins", model.table.quantizer().curvature_bins},
          {"diameter", model.diameter},
          {"leaf", model.parameters.leaf},
          {"low_share", static_cast<double>(low) / count},
          {"high_share", static_cast<double>(high) / count},
          {"weighted_pairs", 2.0 * static_cast<double>(low) * static_cast<double>(high) / (count * count)}};
}

double countOf(const DetectionResult& result, const std::string& stage)
{
  double sum = 0;
  for (const auto& count : result.counts)
    if (count.stage == stage)
      sum += count.count;
  return sum;
}

double processorSeconds()
{
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}
}  // namespace bin_picking::paper
