// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <filesystem>
#include <set>

#include "bin_picking_perception/common/error.hpp"
#include "dataset_readers.hpp"
#include "json_file.hpp"
#include "rigid_pose.hpp"

namespace bin_picking
{
namespace
{
namespace fs = std::filesystem;

constexpr int TRUTH_FORMAT = 1;
constexpr const char* SCAN = "scene.pcd";
constexpr const char* TRUTH = "truth.json";

bool isScene(const fs::path& folder) { return isThere(folder / SCAN) || isThere(folder / TRUTH); }

/// The folder itself, or those in it, by name.
std::vector<fs::path> sceneFolders(const fs::path& path)
{
  if (isScene(path))
    return {path};
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(path))
    if (entry.is_directory() && isScene(entry.path()))
      folders.push_back(entry.path());
  std::sort(folders.begin(), folders.end());
  return folders;
}

Pose readPose(const Json& rows, const std::string& origin)
{
  Eigen::Matrix4d T;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      T(row, column) = rows.at(static_cast<std::size_t>(row)).at(static_cast<std::size_t>(column)).get<double>();
  if (rows.size() != 4 || T.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
    throw FileError(origin + " is not a 4x4 matrix with the last row [0, 0, 0, 1]; write four rows of four numbers.");
  return rigidPose(T.topLeftCorner<3, 3>(), T.topRightCorner<3, 1>(), origin);
}

TrueInstance readInstance(const Json& json, const std::string& path, std::size_t index)
{
  const std::string which = "instance " + std::to_string(index) + " in " + path;
  TrueInstance instance;
  instance.part = json.at("part").get<std::string>();
  instance.T_camera_object = readPose(json.at("T_camera_object"), "The pose of " + which);
  instance.visible_fraction = json.at("visible_fraction").get<double>();
  instance.visible_pixels = json.value("visible_pixels", 0);
  instance.valid_pixels = json.value("valid_pixels", 0);
  if (!(instance.visible_fraction >= 0 && instance.visible_fraction <= 1))
    throw FileError("The visible_fraction of " + which + " is " + std::to_string(instance.visible_fraction) +
                    ", but it must be in [0, 1].");
  return instance;
}

void readTruth(const std::string& path, EvaluationScene& scene)
{
  const Json json = loadJson(path);
  try
  {
    if (const int format = json.at("format").get<int>(); format != TRUTH_FORMAT)
      throw FileError("The file " + path + " has format " + std::to_string(format) +
                      ", but this program reads format " + std::to_string(TRUTH_FORMAT) +
                      "; use the release that wrote it.");
    scene.parts = json.at("parts").get<std::vector<std::string>>();
    for (const Json& instance : json.at("instances"))
      scene.instances.push_back(readInstance(instance, path, scene.instances.size()));
  }
  catch (const nlohmann::json::exception& error)
  {
    failContent(path, error, "{format, parts, instances: [{part, T_camera_object, visible_fraction}]}");
  }
  for (const TrueInstance& instance : scene.instances)
    if (std::find(scene.parts.begin(), scene.parts.end(), instance.part) == scene.parts.end())
      throw FileError("The file " + path + " has an instance of '" + instance.part +
                      "', which is not in its list of parts; add it to \"parts\".");
}

void readCameraSize(const std::string& path, EvaluationScene& scene)
{
  const Json json = loadJson(path);
  try
  {
    scene.width = json.at("width").get<int>();
    scene.height = json.at("height").get<int>();
  }
  catch (const nlohmann::json::exception& error)
  {
    failContent(path, error, "{width, height, fx, fy, cx, cy}");
  }
}

EvaluationScene readScene(const fs::path& folder, int number)
{
  EvaluationScene scene;
  scene.name = fs::canonical(folder).filename().string();  // also of a path that ends in a slash
  scene.scene_id = number;
  scene.file = (folder / SCAN).string();
  if (!isThere(scene.file))
    throw FileError("The scene folder " + folder.string() + " has no " + SCAN + "; get the data set again.");
  readTruth((folder / TRUTH).string(), scene);
  if (isThere(folder / "camera.json"))
    readCameraSize((folder / "camera.json").string(), scene);
  if (isThere(folder / "bin.yaml"))
    scene.bin = loadBin((folder / "bin.yaml").string());
  return scene;
}

PartDefinition findPart(const fs::path& path, const std::string& part, const DatasetSelection& selection)
{
  if (const auto definition = selectedDefinition(part, selection))
    return *definition;
  for (const fs::path& folder : {path / "parts" / part, path / ".." / "parts" / part})
  {
    if (!isThere(folder / "part.yaml"))
      continue;
    PartDefinition definition = loadPart(folder.string());
    if (definition.name != part)
      throw FileError("The part.yaml in " + folder.string() + " describes '" + definition.name + "', but '" + part +
                      "' is searched for; the folder must have the name of its part.");
    return definition;
  }
  throw FileError("The scenes of " + path.string() + " search for the part '" + part + "', but there is no " +
                  (path / "parts" / part / "part.yaml").string() + "; add the folder of the part with --parts.");
}

}  // namespace

bool isOwnDataset(const std::string& path) { return !sceneFolders(path).empty(); }

EvaluationDataset openOwnDataset(const std::string& path, const DatasetSelection& selection)
{
  if (!selection.split.empty())
    throw ParameterError("The split '" + selection.split + "' was selected, but " + path +
                         " is not of the BOP format, which alone has splits; leave it away.");
  EvaluationDataset dataset;
  dataset.path = path;
  for (const fs::path& folder : sceneFolders(path))
    dataset.scenes.push_back(readScene(folder, static_cast<int>(dataset.scenes.size())));
  std::set<std::string> names;
  for (const EvaluationScene& scene : dataset.scenes)
    names.insert(scene.parts.begin(), scene.parts.end());
  const std::vector<std::string> known(names.begin(), names.end());
  const std::vector<std::string> selected = selectedParts(known, selection);
  for (std::size_t k = 0; k < known.size(); ++k)
    if (std::find(selected.begin(), selected.end(), known[k]) != selected.end())
      dataset.parts.push_back({findPart(path, known[k], selection), static_cast<int>(k) + 1, 0});
  keepParts(dataset.scenes, selected);
  return dataset;
}
}  // namespace bin_picking
