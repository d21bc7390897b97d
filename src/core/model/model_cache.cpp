// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <cmath>
#include <filesystem>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/trained_model.hpp"

namespace bin_picking
{
namespace
{
/// Rounded, so that another mathematical library does not make another symmetry.
void writeRounded(std::ostream& out, const double* values, std::ptrdiff_t count)
{
  for (std::ptrdiff_t i = 0; i < count; ++i)
    out << std::llround(values[i] * 1e8) << ' ';
}

std::string symmetryText(const Symmetry& symmetry)
{
  std::ostringstream out;
  out.imbue(std::locale::classic());
  for (const Pose& element : symmetry.discrete)
    writeRounded(out, element.matrix().data(), element.matrix().size());
  if (symmetry.continuous)
  {
    out << "continuous ";
    writeRounded(out, symmetry.continuous->direction.data(), 3);
    writeRounded(out, symmetry.continuous->origin.data(), 3);
  }
  return out.str();
}

/// What is wrong with the model; empty if it can serve.
std::string reasonToTrain(const TrainedModel& model, const PartDefinition& definition,
                          const TrainingParameters& parameters)
{
  if (model.mesh_hash != hashFile(definition.mesh_file))
    return "was made from another mesh than '" + definition.mesh_file + "' is now";
  if (model.parameter_hash != requestHash(definition, parameters))
    return "was made with another name, unit, symmetry or other training parameters";
  return {};
}
}  // namespace

std::uint64_t requestHash(const PartDefinition& definition, const TrainingParameters& parameters)
{
  TrainingParameters effective = parameters;
  setParametersFromYaml(visitor(effective), definition.training_yaml, definition.directory + "/part.yaml");
  std::string request = definition.name + '\n' + toString(definition.mesh_unit) + '\n' +
                        symmetryText(definition.symmetry) + (definition.symmetry_stated ? "stated" : "") + '\n';
  // Paths and values only: a better explanation of a parameter must not make every model stale.
  for (const ParameterEntry& entry : listParameters(visitor(effective)))
    request += entry.path + '=' + entry.value + '\n';
  return hashBytes(request.data(), request.size());
}

std::shared_ptr<const TrainedModel> loadOrTrain(const PartDefinition& definition, const TrainingParameters& parameters,
                                                const std::string& path, const Executor& executor, std::string& note)
{
  note.clear();
  std::string reason = "does not exist yet";
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored))
  {
    try
    {
      std::shared_ptr<const TrainedModel> model = loadModel(path);
      reason = reasonToTrain(*model, definition, parameters);
      if (reason.empty())
        return model;
    }
    catch (const ModelFileError& error)
    {
      reason = std::string("cannot be used: ") + error.what();
    }
  }
  std::shared_ptr<const TrainedModel> model = trainPart(definition, parameters, executor);
  note = "The part '" + definition.name + "' was trained because the model file '" + path + "' " + reason + ".";
  try
  {
    saveModel(*model, path);
  }
  catch (const FileError& error)
  {
    note += std::string(" The new model could not be kept for the next start: ") + error.what() + ".";
  }
  return model;
}
}  // namespace bin_picking
