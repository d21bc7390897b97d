// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bop_scene.hpp"

#include <array>
#include <cstdio>

#include "bin_picking_perception/common/error.hpp"
#include "dataset_readers.hpp"
#include "json_file.hpp"
#include "rigid_pose.hpp"

namespace bin_picking
{
namespace
{
namespace fs = std::filesystem;

constexpr double METRES_PER_MILLIMETRE = 0.001;
constexpr const char* CAMERAS = "scene_camera.json";
constexpr const char* VISIBILITY = "scene_gt_info.json";

std::string sixDigits(int number)
{
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%06d", number);
  return text.data();
}

template <int ROWS, int COLUMNS>
Eigen::Matrix<double, ROWS, COLUMNS> readMatrix(const Json& json)
{
  Eigen::Matrix<double, ROWS, COLUMNS> matrix;
  for (int k = 0; k < ROWS * COLUMNS; ++k)
    matrix(k / COLUMNS, k % COLUMNS) = json.at(static_cast<std::size_t>(k)).get<double>();
  return matrix;
}

/// The number that a key or the name of a folder is.
int numberOf(const std::string& text, const std::string& where)
{
  std::size_t used = 0;
  int number = -1;
  try
  {
    number = std::stoi(text, &used);
  }
  catch (const std::logic_error&)
  {
    used = 0;
  }
  if (used != text.size() || number < 0)
    throw FileError(where + " is called '" + text + "', but the BOP format numbers its scenes and images.");
  return number;
}

/// One scene folder.
class BopScene
{
public:
  explicit BopScene(const fs::path& folder)
      : folder_(folder),
        id_(numberOf(folder.filename().string(), "A scene folder in " + folder.parent_path().string())),
        truth_(loadJson((folder / BOP_TRUTH).string())),
        cameras_(loadJson((folder / CAMERAS).string())),
        visibility_(isThere(folder / VISIBILITY) ? loadJson((folder / VISIBILITY).string()) : Json())
  {}

  std::vector<EvaluationScene> images(const BopTargets& targets) const
  {
    std::map<int, std::string> keys;  // by number: as text 10 comes before 9
    for (const auto& [key, instances] : truth_.items())
      keys.emplace(numberOf(key, "An image in " + (folder_ / BOP_TRUTH).string()), key);
    std::vector<EvaluationScene> images;
    for (const auto& [image_id, key] : keys)
    {
      const auto target = targets.find({id_, image_id});
      if (targets.empty() || target != targets.end())
        images.push_back(readImage(key, image_id, targets.empty() ? std::set<int>() : target->second));
    }
    return images;
  }

private:
  EvaluationScene readImage(const std::string& key, int image_id, std::set<int> objects) const
  {
    EvaluationScene scene;
    scene.name = folder_.filename().string() + "/" + sixDigits(image_id);
    scene.scene_id = id_;
    scene.image_id = image_id;
    scene.file = findPicture({"depth"}, image_id);
    if (scene.file.empty())
      throw FileError("The depth picture " + (folder_ / "depth" / (sixDigits(image_id) + ".png")).string() +
                      " (or .tif) is missing, but the truth of its scene names it; get the data set again.");
    scene.depth_image = readCamera(key);
    scene.depth_image->color_image = findPicture({"rgb", "gray"}, image_id);
    if (objects.empty())
      objects = annotatedObjects(key);
    readInstances(key, objects, scene);
    for (const int object : objects)
      scene.parts.push_back(bopPartName(object));
    return scene;
  }

  std::set<int> annotatedObjects(const std::string& key) const
  {
    std::set<int> objects;
    try
    {
      for (const Json& instance : truth_.at(key))
        objects.insert(instance.at("obj_id").get<int>());
    }
    catch (const nlohmann::json::exception& error)
    {
      failTruth(error);
    }
    return objects;
  }

  void readInstances(const std::string& key, const std::set<int>& objects, EvaluationScene& scene) const
  {
    const Json& instances = truth_.at(key);
    try
    {
      for (std::size_t k = 0; k < instances.size(); ++k)
        if (objects.count(instances.at(k).at("obj_id").get<int>()) > 0)
          scene.instances.push_back(readInstance(instances.at(k), key, k));
    }
    catch (const nlohmann::json::exception& error)
    {
      failTruth(error);
    }
  }

  [[noreturn]] void failTruth(const nlohmann::json::exception& error) const
  {
    failContent((folder_ / BOP_TRUTH).string(), error, "{IMAGE: [{obj_id, cam_R_m2c, cam_t_m2c}]}");
  }

  DepthImageFormat readCamera(const std::string& key) const
  {
    DepthImageFormat format;
    try
    {
      const Json& camera = cameras_.at(key);
      const auto K = readMatrix<3, 3>(camera.at("cam_K"));
      format.camera = {K(0, 0), K(1, 1), K(0, 2), K(1, 2)};
      format.step = camera.at("depth_scale").get<double>() * METRES_PER_MILLIMETRE;
    }
    catch (const nlohmann::json::exception& error)
    {
      failContent((folder_ / CAMERAS).string(), error, "{IMAGE: {cam_K, depth_scale}}");
    }
    if (!(format.camera.fx > 0 && format.camera.fy > 0 && format.step > 0))
      throw FileError("The camera of image " + key + " in " + (folder_ / CAMERAS).string() +
                      " has a focal length or depth_scale that is not positive; get the data set again.");
    return format;
  }

  TrueInstance readInstance(const Json& json, const std::string& key, std::size_t index) const
  {
    TrueInstance instance;
    instance.part = bopPartName(json.at("obj_id").get<int>());
    instance.T_camera_object = rigidPose(
        readMatrix<3, 3>(json.at("cam_R_m2c")), readMatrix<3, 1>(json.at("cam_t_m2c")) * METRES_PER_MILLIMETRE,
        "The pose of instance " + std::to_string(index) + " of image " + key + " in " + (folder_ / BOP_TRUTH).string());
    if (visibility_.is_null())
      return instance;
    try
    {
      const Json& info = visibility_.at(key).at(index);
      instance.visible_fraction = info.at("visib_fract").get<double>();
      instance.visible_pixels = info.value("px_count_visib", 0);
    }
    catch (const nlohmann::json::exception& error)
    {
      failContent((folder_ / VISIBILITY).string(), error, "{IMAGE: [{visib_fract}]} with one entry per true pose");
    }
    return instance;
  }

  /// Empty if there is none.
  std::string findPicture(const std::vector<std::string>& folders, int image_id) const
  {
    for (const std::string& folder : folders)
      for (const char* ending : {".png", ".tif", ".tiff", ".jpg"})
        if (const fs::path file = folder_ / folder / (sixDigits(image_id) + ending); isThere(file))
          return file.string();
    return {};
  }

  fs::path folder_;
  int id_;
  Json truth_;
  Json cameras_;
  Json visibility_;
};
}  // namespace

std::string bopPartName(int object_id) { return "obj_" + sixDigits(object_id); }

std::vector<EvaluationScene> readBopScene(const fs::path& folder, const BopTargets& targets)
{
  return BopScene(folder).images(targets);
}
}  // namespace bin_picking
