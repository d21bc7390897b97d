// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "evaluation_models.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "detector_options.hpp"

namespace bin_picking::tools
{
namespace
{
namespace fs = std::filesystem;
using Models = std::vector<std::shared_ptr<const TrainedModel>>;

fs::path cacheFolder(const Arguments& arguments)
{
  fs::path folder = arguments.value("--cache");
  const char* cache = std::getenv("XDG_CACHE_HOME");
  const char* home = std::getenv("HOME");
  if (folder.empty() && cache && *cache)
    folder = fs::path(cache) / "bin_picking";
  else if (folder.empty() && home && *home)
    folder = fs::path(home) / ".cache" / "bin_picking";
  if (folder.empty())
    throw UsageError("there is no home folder to keep trained models in; say where with --cache DIR");
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw FileError("cannot make the folder '" + folder.string() + "' for trained models (" + error.message() +
                    "); choose another with --cache DIR");
  return folder;
}

/// One file per part, mesh and parameters, so that evaluations with others do not throw each other's models away.
std::string cacheFile(const fs::path& folder, const PartDefinition& part, const TrainingParameters& training)
{
  std::array<char, 20> hash{};
  std::snprintf(hash.data(), hash.size(), "%016llx",
                static_cast<unsigned long long>(requestHash(part, training) ^ hashFile(part.mesh_file)));
  return (folder / (part.name + "-" + hash.data() + ".model")).string();
}

Models trainedModels(const Arguments& arguments, const EvaluationDataset& dataset, Progress& progress)
{
  Configuration configuration;
  applyConfigFile(arguments, configuration);
  const fs::path folder = cacheFolder(arguments);
  const Executor executor(parseInteger(arguments.value("--threads", "0"), "--threads", 0, 1024));
  Models models;
  for (const EvaluationPart& part : dataset.parts)
  {
    progress.show("loading or training " + part.definition.name);
    const std::string file = cacheFile(folder, part.definition, configuration.training);
    std::string note;
    models.push_back(loadOrTrain(part.definition, configuration.training, file, executor, note));
  }
  return models;
}

Models givenModels(const Arguments& arguments, const EvaluationDataset& dataset)
{
  const Models all = loadModels(arguments.values("--model"));
  Models models;
  for (const EvaluationPart& part : dataset.parts)
  {
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const auto& model) { return model->name == part.definition.name; });
    if (found == all.end())
      throw UsageError("the scenes search for the part '" + part.definition.name +
                       "', but no --model is of it; add its model, or select others with --parts");
    models.push_back(*found);
  }
  return models;
}
}  // namespace

std::vector<std::shared_ptr<const TrainedModel>> modelsFor(const EvaluationDataset& dataset, const Arguments& arguments,
                                                           Progress& progress)
{
  return arguments.has("--model") ? givenModels(arguments, dataset) : trainedModels(arguments, dataset, progress);
}
}  // namespace bin_picking::tools
