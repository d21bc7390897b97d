// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "scene_files.hpp"

#include <filesystem>
#include <fstream>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/evaluation/scan_picture.hpp"
#include "bin_picking_perception/scene/cloud_input.hpp"

namespace bin_picking::simulation
{
namespace
{
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int FORMAT = 1;

void writeText(const fs::path& path, const std::string& text)
{
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file)
    throw FileError("cannot write '" + path.string() + "'; check that the folder exists and has room");
}

std::string sensorName(SensorParameters parameters)
{
  return listParameters(visitor(parameters)).front().value;  // the type comes first
}

Json toJson(const Pose& T)
{
  Json rows = Json::array();
  for (int row = 0; row < 4; ++row)
    rows.push_back({T(row, 0), T(row, 1), T(row, 2), T(row, 3)});
  return rows;
}

std::string cameraJson(const DepthGrid& grid)
{
  const PinholeCamera& camera = grid.camera;
  return Json({{"width", grid.width},
               {"height", grid.height},
               {"fx", camera.fx},
               {"fy", camera.fy},
               {"cx", camera.cx},
               {"cy", camera.cy}})
             .dump(1) +
         "\n";
}

std::string truthJson(const CellScan& scan, const VirtualCell& cell, std::uint32_t seed)
{
  Json json;
  json["format"] = FORMAT;
  json["seed"] = seed;
  json["sensor"] = sensorName(cell.parameters().sensor);
  json["parts"] = Json::array();
  for (const CellPart& part : cell.parts())
    json["parts"].push_back(part.name);
  json["instances"] = Json::array();
  for (const CellInstance& instance : scan.instances)
    json["instances"].push_back({{"part", cell.parts()[static_cast<std::size_t>(instance.part)].name},
                                 {"T_camera_object", toJson(instance.T_camera_object)},
                                 {"visible_fraction", instance.view.visible_fraction},
                                 {"visible_pixels", instance.view.visible_pixels},
                                 {"valid_pixels", instance.view.valid_pixels}});
  return json.dump(1) + "\n";
}
}  // namespace

std::string toYaml(const Bin& bin)
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

bool holdsVirtualScene(const std::string& folder)
{
  std::ifstream file(fs::path(folder) / "truth.json");
  const Json truth = Json::parse(file, nullptr, false);
  return truth.is_object() && truth.contains("seed") && truth.contains("sensor");
}

void writeScene(const CellScan& scan, const VirtualCell& cell, std::uint32_t seed, const std::string& folder)
{
  const fs::path path(folder);
  saveGrid(scan.scan.grid, (path / "scene.pcd").string());
  writeText(path / "bin.yaml", toYaml(cell.bin()));
  writeText(path / "camera.json", cameraJson(scan.scan.grid));
  writeText(path / "truth.json", truthJson(scan, cell, seed));
  saveScanPicture(scan.scan.grid, scan.scan.labels, (path / "scene.png").string());
}
}  // namespace bin_picking::simulation
