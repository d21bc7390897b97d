// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "demo_scene.hpp"

#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/evaluation/detection_picture.hpp"
#include "bin_picking_perception/scene/cloud_input.hpp"
#include "commands.hpp"
#include "detector_options.hpp"
#include "report.hpp"
#include "terminal.hpp"

namespace bin_picking::tools
{
namespace
{
namespace fs = std::filesystem;
using simulation::DemoScene;

simulation::DemoSceneParameters sceneParameters(const Arguments& arguments)
{
  simulation::DemoSceneParameters parameters;
  if (arguments.has("--count"))
    setParameter(visitor(parameters), "pile/count", arguments.value("--count"));
  if (arguments.has("--seed"))
  {
    setParameter(visitor(parameters), "pile/seed", arguments.value("--seed"));
    setParameter(visitor(parameters), "sensor/seed", arguments.value("--seed"));
  }
  if (arguments.has("--size"))
  {
    const std::string& size = arguments.value("--size");
    const auto cross = size.find('x');
    if (cross == std::string::npos)
      throw UsageError("--size is '" + size + "', but it must be WIDTHxHEIGHT in pixels, for example 1280x1024");
    setParameter(visitor(parameters), "sensor/width", size.substr(0, cross));
    setParameter(visitor(parameters), "sensor/height", size.substr(cross + 1));
  }
  applyAssignments(arguments, visitor(parameters));
  return parameters;
}

std::string binYaml(const Bin& bin)
{
  const Eigen::Vector3d t = bin.T_camera_bin.translation();
  const Eigen::Quaterniond q(bin.T_camera_bin.linear());
  std::ostringstream out;
  out << std::setprecision(12) << "# Pose in the camera frame (x right, y down, z forward); metres.\n"
      << "pose:\n"
      << "  position: [" << t.x() << ", " << t.y() << ", " << t.z() << "]\n"
      << "  orientation: [" << q.x() << ", " << q.y() << ", " << q.z() << ", " << q.w() << "]  # qx, qy, qz, qw\n"
      << "inner_size: [" << bin.inner_size.x() << ", " << bin.inner_size.y() << ", " << bin.inner_size.z() << "]\n"
      << "wall_thickness: " << bin.wall_thickness << "\n";
  return out.str();
}

std::string truthJson(const DemoScene& scene, const std::string& part)
{
  nlohmann::json json;
  json["part"] = part;
  json["instances"] = nlohmann::json::array();
  for (const auto& instance : scene.instances)
    json["instances"].push_back({{"T_camera_object", toJson(instance.T_camera_object)},
                                 {"visible_fraction", instance.visible_fraction},
                                 {"visible_pixels", instance.visible_pixels}});
  return json.dump(1) + "\n";
}

/// Brightness of a pixel under a lamp beside the camera; 0 where nothing was measured. Over two pixels each way, so
/// that noise does not drown the shape.
double brightness(const DepthGrid& grid, int u, int v)
{
  constexpr int REACH = 2;
  if (!grid.inside(u - REACH, v - REACH) || !grid.inside(u + REACH, v + REACH))
    return 0;
  const Eigen::Vector3f across = grid.point(grid.index(u + REACH, v)) - grid.point(grid.index(u - REACH, v));
  const Eigen::Vector3f down = grid.point(grid.index(u, v + REACH)) - grid.point(grid.index(u, v - REACH));
  const Eigen::Vector3f normal = down.cross(across).normalized();
  const double shade = normal.dot(Eigen::Vector3f(0.3f, -0.3f, -0.9f).normalized());
  return grid.valid(grid.index(u, v)) && std::isfinite(shade) ? 0.15 + 0.85 * std::max(shade, 0.0) : 0;
}

/// The shaded surface, each part in the colour of its number, the bin grey, not measured black.
void savePicture(const DemoScene& scene, const std::string& path)
{
  cv::Mat picture(scene.grid.height, scene.grid.width, CV_8UC3);
  for (int v = 0; v < scene.grid.height; ++v)
    for (int u = 0; u < scene.grid.width; ++u)
    {
      const std::int32_t label = scene.labels[static_cast<std::size_t>(scene.grid.index(u, v))];
      const Eigen::Vector3f color = label < 0 ? Eigen::Vector3f::Constant(0.6f)
                                              : Eigen::Vector3f(0.35f * rankColor(static_cast<std::size_t>(label) % 6) +
                                                                Eigen::Vector3f::Constant(0.55f));
      const Eigen::Vector3f shaded = 255 * static_cast<float>(brightness(scene.grid, u, v)) * color;
      picture.at<cv::Vec3b>(v, u) = {cv::saturate_cast<uchar>(shaded.z()), cv::saturate_cast<uchar>(shaded.y()),
                                     cv::saturate_cast<uchar>(shaded.x())};
    }
  if (!cv::imwrite(path, picture))
    throw FileError("cannot write the picture '" + path + "'; check that the folder exists and has room");
}

void demoScene(const Arguments& arguments)
{
  const simulation::DemoSceneParameters parameters = sceneParameters(arguments);
  const PartDefinition part = loadPart(arguments.positional(0));
  const TriangleMesh mesh = loadMesh(part.mesh_file, part.mesh_unit);
  Progress progress;
  progress.show("filling the bin");
  const DemoScene scene = makeDemoScene(mesh, parameters);
  const fs::path folder = arguments.value("-o");
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw FileError("cannot make the folder '" + folder.string() + "' (" + error.message() + ")");
  progress.show("writing");
  saveGrid(scene.grid, (folder / "scene.pcd").string());
  writeText((folder / "bin.yaml").string(), binYaml(scene.bin));
  writeText((folder / "truth.json").string(), truthJson(scene, part.name));
  savePicture(scene, (folder / "scene.png").string());
  progress.finish();
  std::cout << scene.instances.size() << " x " << part.name << " in a bin of " << scene.bin.inner_size.x() << " x "
            << scene.bin.inner_size.y() << " x " << scene.bin.inner_size.z() << " m, " << scene.grid.width << " x "
            << scene.grid.height << " pixels: " << (folder / "scene.pcd").string()
            << ", bin.yaml, truth.json, scene.png\n";
}
}  // namespace

Command demoSceneCommand()
{
  return {{"demo-scene",
           "Makes a virtual scan of a bin full of one part, with the true poses beside it.",
           {"PART_DIR"},
           {{"--count", "N", Values::One, "number of parts (default 25)"},
            {"--seed", "N", Values::One, "another number gives another scene (default 1)"},
            {"--size", "WIDTHxHEIGHT", Values::One, "pixels of the camera (default 1280x1024)"},
            {"--set", "KEY=VALUE", Values::Assignments, "single parameters; 'bin_picking parameters --of demo-scene'"},
            {"-o", "DIR", Values::One, "folder to write to; made if it does not exist", true}},
           "demo-scene config/parts/three_way_tube --count 25 -o scene"},
          demoScene};
}
}  // namespace bin_picking::tools
