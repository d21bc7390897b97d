// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/evaluation_dataset.hpp"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <filesystem>

#include "bin_picking_perception/common/error.hpp"
#include "dataset_readers.hpp"

namespace bin_picking
{
namespace
{
namespace fs = std::filesystem;

bool describesPart(const std::string& path)
{
  return isThere(fs::path(path) / "part.yaml") || fs::path(path).extension() == ".yaml";
}

std::string join(const std::vector<std::string>& words)
{
  std::string text;
  for (const std::string& word : words)
    text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// Leaves away what no scene that is left searches for.
void dropUnusedParts(EvaluationDataset& dataset)
{
  const auto unused = [&](const EvaluationPart& part) {
    return std::none_of(dataset.scenes.begin(), dataset.scenes.end(), [&](const EvaluationScene& scene) {
      return std::count(scene.parts.begin(), scene.parts.end(), part.definition.name) > 0;
    });
  };
  dataset.parts.erase(std::remove_if(dataset.parts.begin(), dataset.parts.end(), unused), dataset.parts.end());
}

void requireSize(const EvaluationScene& scene, int width, int height)
{
  if (scene.width > 0 && (width != scene.width || height != scene.height))
    throw FileError("The scan " + scene.file + " has " + std::to_string(width) + " x " + std::to_string(height) +
                    " pixels, but the camera of its scene has " + std::to_string(scene.width) + " x " +
                    std::to_string(scene.height) + "; scan and camera file must belong together.");
}
}  // namespace

bool isThere(const fs::path& path)
{
  std::error_code ignored;
  return fs::exists(path, ignored);
}

EvaluationDataset openDataset(const std::string& path, const DatasetSelection& selection)
{
  std::error_code ignored;
  if (!fs::is_directory(path, ignored))
    throw FileError("The data set " + path +
                    " is not a folder that can be read; give the folder that holds its scenes.");
  const bool is_own = isOwnDataset(path);
  if (!is_own && !isBopDataset(path))
    throw FileError(
        "The folder " + path +
        " is no data set that is understood: it has neither scene folders with "
        "scene.pcd and truth.json, nor models/models_info.json as the BOP benchmark has; give another folder.");
  EvaluationDataset dataset = is_own ? openOwnDataset(path, selection) : openBopDataset(path, selection);
  if (dataset.scenes.empty())
    throw FileError("The data set " + path +
                    " has no scene in which the selected parts are searched for; select others.");
  if (selection.max_scenes > 0 && dataset.scenes.size() > static_cast<std::size_t>(selection.max_scenes))
    dataset.scenes.resize(static_cast<std::size_t>(selection.max_scenes));
  dropUnusedParts(dataset);
  return dataset;
}

pcl::PointCloud<pcl::PointXYZ> loadSceneCloud(const EvaluationScene& scene)
{
  pcl::PointCloud<pcl::PointXYZ> cloud = loadCloud(scene.file);
  requireSize(scene, static_cast<int>(cloud.width), static_cast<int>(cloud.height));
  return cloud;
}

DepthGrid loadSceneGrid(const EvaluationScene& scene, const InputParameters& parameters)
{
  if (!scene.depth_image)
    return makeGrid(loadSceneCloud(scene), parameters);
  DepthGrid grid = loadDepthImage(scene.file, *scene.depth_image);
  requireSize(scene, grid.width, grid.height);
  return grid;
}

std::optional<PartDefinition> selectedDefinition(const std::string& part, const DatasetSelection& selection)
{
  for (const std::string& value : selection.parts)
    if (describesPart(value))
      if (PartDefinition definition = loadPart(value); definition.name == part)
        return definition;
  return std::nullopt;
}

std::vector<std::string> selectedParts(const std::vector<std::string>& known, const DatasetSelection& selection)
{
  if (selection.parts.empty())
    return known;
  std::vector<std::string> selected;
  for (const std::string& value : selection.parts)
  {
    const std::string name = describesPart(value) ? loadPart(value).name : value;
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw ParameterError("The part '" + name + "' was selected, but the data set has only: " + join(known) + ".");
    selected.push_back(name);
  }
  return selected;
}

void keepParts(std::vector<EvaluationScene>& scenes, const std::vector<std::string>& selected)
{
  const auto unselected = [&](const std::string& part) {
    return std::find(selected.begin(), selected.end(), part) == selected.end();
  };
  for (EvaluationScene& scene : scenes)
  {
    scene.parts.erase(std::remove_if(scene.parts.begin(), scene.parts.end(), unselected), scene.parts.end());
    scene.instances.erase(std::remove_if(scene.instances.begin(), scene.instances.end(),
                                         [&](const TrueInstance& instance) { return unselected(instance.part); }),
                          scene.instances.end());
  }
  scenes.erase(
      std::remove_if(scenes.begin(), scenes.end(), [](const EvaluationScene& scene) { return scene.parts.empty(); }),
      scenes.end());
}
}  // namespace bin_picking
