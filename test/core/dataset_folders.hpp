// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "bin_picking_perception/model/depth_renderer.hpp"
#include "bin_picking_perception/scene/cloud_input.hpp"
#include "core/mesh_shapes.hpp"
#include "core/temporary_folder.hpp"

namespace bin_picking
{
namespace test
{
using Json = nlohmann::json;

inline PinholeCamera pictureCamera() { return {300, 310, 79.5, 59.5}; }

/// The bar of the data sets: 80 x 40 x 20 mm.
inline TriangleMesh barMesh() { return box(0.08f, 0.04f, 0.02f); }

inline Pose barPose()
{
  return Eigen::Translation3d(0.01, -0.02, 0.6) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX());
}

/// The bar before a wall at 0.8 m.
inline DepthGrid barScan(const Pose& T_camera_object)
{
  TriangleMesh wall;
  wall.vertices = {{-1, -1, 0.8f}, {1, -1, 0.8f}, {1, 1, 0.8f}, {-1, 1, 0.8f}};
  wall.triangles = {{0, 1, 2}, {0, 2, 3}};
  DepthRenderer renderer(160, 120, pictureCamera());
  renderer.draw(wall, Pose::Identity(), 0);
  renderer.draw(barMesh(), T_camera_object, 1);
  return renderer.grid();
}

inline Json rowsOf(const Pose& T)
{
  Json rows = Json::array();
  for (int row = 0; row < 4; ++row)
    rows.push_back({T(row, 0), T(row, 1), T(row, 2), T(row, 3)});
  return rows;
}

inline Json truthOf(const std::vector<std::string>& parts, const std::vector<Pose>& bars)
{
  Json truth = {{"format", 1}, {"seed", 7}, {"sensor", "ideal"}, {"parts", parts}, {"instances", Json::array()}};
  for (const Pose& T : bars)
    truth["instances"].push_back({{"part", "bar"},
                                  {"T_camera_object", rowsOf(T)},
                                  {"visible_fraction", 0.93},
                                  {"visible_pixels", 500},
                                  {"valid_pixels", 450}});
  return truth;
}

/// A data set of the own format: `full` holds one bar, `empty` none.
class OwnFolder : public TemporaryFolder
{
public:
  OwnFolder()
  {
    writeFile("parts/bar/part.yaml",
              "format: 1\nname: bar\nmesh: {file: bar.stl, unit: m}\n"
              "symmetry: {discrete: [{axis: [0, 0, 1], order: 2, origin: [0, 0, 0]}]}\n");
    writeFile("parts/bar/bar.stl", binaryStl(barMesh(), "bar"));
    writeScene("full", {barPose()});
    writeScene("empty", {});
  }

  void writeFile(const std::string& name, const std::string& content) const
  {
    std::filesystem::create_directories(std::filesystem::path(path(name)).parent_path());
    write(name, content);
  }

  void writeScene(const std::string& name, const std::vector<Pose>& bars) const
  {
    writeFile(name + "/truth.json", truthOf({"bar"}, bars).dump());
    saveGrid(barScan(bars.empty() ? Pose(Eigen::Translation3d(0, 0, 9)) : bars[0]), path(name + "/scene.pcd"));
  }
};

inline TriangleMesh inMillimetres(TriangleMesh mesh)
{
  for (auto& vertex : mesh.vertices)
    vertex *= 1000;
  return mesh;
}

inline Json bopInstance(int object, const Pose& T)
{
  Json R = Json::array();
  for (int k = 0; k < 9; ++k)
    R.push_back(T.linear()(k / 3, k % 3));
  const Eigen::Vector3d t = T.translation() * 1000;
  return {{"obj_id", object}, {"cam_R_m2c", R}, {"cam_t_m2c", {t.x(), t.y(), t.z()}}};
}

/// A data set of the BOP format: scene 3 of the split `val` with images 9 and 10 of one bar, object 5.
class BopFolder : public OwnFolder
{
public:
  static constexpr double STEP = 0.1;  // depth_scale: millimetres per unit

  BopFolder()
  {
    for (const char* own : {"parts", "full", "empty"})
      std::filesystem::remove_all(path(own));
    writeFile("models/models_info.json",
              Json({{"5",
                     {{"diameter", 91.6515},
                      {"min_x", -40},
                      {"min_y", -20},
                      {"min_z", -10},
                      {"size_x", 80},
                      {"size_y", 40},
                      {"size_z", 20},
                      {"symmetries_discrete", {{-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}}}}})
                  .dump());
    writeFile("models/obj_000005.ply", asciiPly(inMillimetres(barMesh())));
    const Json camera = {{"cam_K", {300, 0, 79.5, 0, 310, 59.5, 0, 0, 1}}, {"depth_scale", STEP}};
    writeFile("val/000003/scene_camera.json", Json({{"9", camera}, {"10", camera}}).dump());
    writeTruth(Json({{"9", {bopInstance(5, barPose())}}, {"10", {bopInstance(5, barPose())}}}));
    writeDepth("val/000003/depth/000009.png", barScan(barPose()));
    writeDepth("val/000003/depth/000010.tif", barScan(barPose()));
  }

  void writeTruth(const Json& truth) const { writeFile("val/000003/scene_gt.json", truth.dump()); }

  void writeDepth(const std::string& name, const DepthGrid& grid) const
  {
    cv::Mat depth = cv::Mat::zeros(grid.height, grid.width, CV_16UC1);
    for (int v = 0; v < grid.height; ++v)
      for (int u = 0; u < grid.width; ++u)
        if (const int i = grid.index(u, v); grid.valid(i))
          depth.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(
              std::lround(static_cast<double>(grid.z[static_cast<std::size_t>(i)]) * 1000 / STEP));
    std::filesystem::create_directories(std::filesystem::path(path(name)).parent_path());
    if (!cv::imwrite(path(name), depth))
      throw std::runtime_error("cannot write " + name);
  }
};
}  // namespace test
}  // namespace bin_picking
