// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <filesystem>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/models_info.hpp"
#include "bop_scene.hpp"
#include "dataset_readers.hpp"
#include "json_file.hpp"

namespace bin_picking
{
namespace
{
namespace fs = std::filesystem;

constexpr const char* TARGETS = "test_targets_bop19.json";

/// The meshes as they were made, before those that were thinned for the benchmark's own errors.
fs::path modelsFolder(const fs::path& path)
{
  for (const char* name : {"models", "models_cad", "models_eval"})
    if (isThere(path / name / "models_info.json"))
      return path / name;
  return {};
}

std::vector<fs::path> sortedFolders(const fs::path& path)
{
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(path))
    if (entry.is_directory())
      folders.push_back(entry.path());
  std::sort(folders.begin(), folders.end());
  return folders;
}

std::vector<fs::path> sceneFolders(const fs::path& split)
{
  std::vector<fs::path> scenes;
  for (const fs::path& folder : sortedFolders(split))
    if (isThere(folder / BOP_TRUTH))
      scenes.push_back(folder);
  return scenes;
}

fs::path findSplit(const fs::path& path, const std::string& wanted)
{
  std::vector<fs::path> splits;
  std::string names;
  for (const fs::path& folder : sortedFolders(path))
    if (!sceneFolders(folder).empty())
    {
      splits.push_back(folder);
      names += (names.empty() ? "" : ", ") + folder.filename().string();
    }
  if (splits.empty())
    throw FileError("The data set " + path.string() + " has no split with true poses (SPLIT/SCENE/" + BOP_TRUTH +
                    "); get one whose truth is public, for example its val split.");
  for (const fs::path& split : splits)
    if (split.filename() == wanted)
      return split;
  if (wanted.empty() && splits.size() == 1)
    return splits[0];
  throw ParameterError(
      wanted.empty()
          ? "The data set " + path.string() + " has several splits: " + names + "; choose one with --split."
          : "The split '" + wanted + "' is not in " + path.string() + ", which has true poses for: " + names + ".");
}

BopTargets readTargets(const std::string& path)
{
  const Json json = loadJson(path);
  BopTargets targets;
  try
  {
    for (const Json& target : json)
      targets[{target.at("scene_id").get<int>(), target.at("im_id").get<int>()}].insert(target.at("obj_id").get<int>());
  }
  catch (const nlohmann::json::exception& error)
  {
    failContent(path, error, "[{scene_id, im_id, obj_id, inst_count}]");
  }
  return targets;
}

EvaluationPart findPart(const std::string& name, const std::map<int, ModelInfo>& models, const fs::path& folder,
                        const DatasetSelection& selection)
{
  for (const auto& [id, info] : models)
  {
    if (bopPartName(id) != name)
      continue;
    if (const auto definition = selectedDefinition(name, selection))
      return {*definition, id, 0};
    PartDefinition part;
    part.name = name;
    part.directory = folder.string();
    part.mesh_file = (folder / (name + ".ply")).string();
    part.mesh_unit = LengthUnit::Millimetre;
    part.symmetry = info.symmetry;
    part.symmetry_stated = true;
    if (!isThere(part.mesh_file))
      throw FileError("The mesh " + part.mesh_file +
                      " is missing, but the truth of the data set names its object; get "
                      "the models again.");
    return {part, id, info.diameter};
  }
  throw FileError("The truth or the targets name the object '" + name + "', which " +
                  (folder / "models_info.json").string() + " does not have; get the data set again.");
}
}  // namespace

bool isBopDataset(const std::string& path) { return !modelsFolder(path).empty(); }

EvaluationDataset openBopDataset(const std::string& path, const DatasetSelection& selection)
{
  EvaluationDataset dataset;
  dataset.path = path;
  const fs::path models_folder = modelsFolder(path);
  const auto models = loadModelsInfo((models_folder / "models_info.json").string());
  const fs::path split = findSplit(path, selection.split);
  const bool has_targets = split.filename().string().rfind("test", 0) == 0 && isThere(fs::path(path) / TARGETS);
  const BopTargets targets = has_targets ? readTargets((fs::path(path) / TARGETS).string()) : BopTargets();
  std::set<std::string> known;
  for (const fs::path& folder : sceneFolders(split))
    for (EvaluationScene& image : readBopScene(folder, targets))
    {
      known.insert(image.parts.begin(), image.parts.end());
      dataset.scenes.push_back(std::move(image));
    }
  const auto selected = selectedParts({known.begin(), known.end()}, selection);
  for (const std::string& part : known)
    if (std::find(selected.begin(), selected.end(), part) != selected.end())
      dataset.parts.push_back(findPart(part, models, models_folder, selection));
  keepParts(dataset.scenes, selected);
  return dataset;
}
}  // namespace bin_picking
