// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "peer_data.hpp"

#include <malloc.h>

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <fstream>
#include <map>

#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/depth_renderer.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"

namespace bin_picking::peers
{
namespace
{
constexpr double SURFACE_SPACING = 0.01;  // of the diameter
constexpr double NORMAL_RADIUS = 0.05;    // of the diameter

OrientedPoints measuredPoints(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& normals)
{
  OrientedPoints points;
  for (int i = 0; i < static_cast<int>(grid.size()); ++i)
  {
    const Eigen::Vector3f& normal = normals[static_cast<std::size_t>(i)];
    if (!grid.valid(i) || !normal.allFinite())
      continue;
    points.points.push_back(grid.point(i));
    points.normals.push_back(normal);
  }
  return points;
}
}  // namespace

double cpuSeconds()
{
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Memory memory()
{
  Memory memory;
  std::ifstream status("/proc/self/status");
  std::string key;
  while (status >> key)
  {
    double kilobytes = 0;
    if (key == "VmRSS:" && status >> kilobytes)
      memory.resident = 1024 * kilobytes;
    else if (key == "VmHWM:" && status >> kilobytes)
      memory.peak = 1024 * kilobytes;
  }
  return memory;
}

void resetPeakMemory()
{
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

OrientedPoints sampledInCubes(const OrientedPoints& dense, double edge)
{
  struct Cube
  {
    std::array<Eigen::Vector3d, 2> point = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    std::array<Eigen::Vector3d, 2> normal = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    std::array<int, 2> count = {0, 0};
  };
  std::map<std::array<int, 3>, Cube> cubes;
  for (std::size_t i = 0; i < dense.size(); ++i)
  {
    const Eigen::Vector3d p = dense.points[i].cast<double>();
    const Eigen::Vector3d n = dense.normals[i].cast<double>();
    const Eigen::Vector3i cell = (p / edge).array().floor().cast<int>();
    Cube& cube = cubes[{cell.x(), cell.y(), cell.z()}];
    const std::size_t face = cube.count[0] > 0 && cube.normal[0].dot(n) < 0 ? 1 : 0;
    cube.point[face] += p;
    cube.normal[face] += n;
    ++cube.count[face];
  }
  OrientedPoints sampled;
  for (const auto& entry : cubes)
    for (std::size_t face = 0; face < 2; ++face)
      if (entry.second.count[face] > 0 && entry.second.normal[face].norm() > 1e-6)
      {
        sampled.points.push_back((entry.second.point[face] / entry.second.count[face]).cast<float>());
        sampled.normals.push_back(entry.second.normal[face].normalized().cast<float>());
      }
  return sampled;
}

PeerModel makePeerModel(const PartDefinition& definition)
{
  PeerModel model;
  model.definition = definition;
  model.mesh = loadMesh(definition.mesh_file, definition.mesh_unit);
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : model.mesh.vertices)
    box.extend(vertex);
  model.size = box.sizes().cast<double>();
  model.center = box.center().cast<double>();
  model.diameter = largestDistance(model.mesh.vertices);
  model.surface = sampleSurface(model.mesh, SURFACE_SPACING * model.diameter, 1);
  return model;
}

PeerScene loadPeerScene(const EvaluationScene& scene, const PeerModel& model)
{
  const InputParameters input;
  PeerScene loaded;
  if (!scene.depth_image)
    loaded.cloud = loadSceneCloud(scene);
  loaded.grid = scene.depth_image ? loadSceneGrid(scene, input) : makeGrid(loaded.cloud, input);
  loaded.bin = scene.bin;
  DepthGrid searched = reduceGrid(loaded.grid, scene.bin ? 2 : 1, Executor(1));
  cropToRegion(searched, input, scene.bin ? &*scene.bin : nullptr, Executor(1));
  loaded.points = measuredPoints(searched, estimateGridNormals(searched, NORMAL_RADIUS * model.diameter, Executor(1)));
  loaded.fine = sampledInCubes(loaded.points, SURFACE_SPACING * model.diameter);
  return loaded;
}

OrientedPoints seenPoints(const PeerModel& model, const OrientedPoints& points, const Pose& T_camera_object)
{
  constexpr int SIZE = 200;
  constexpr double MIN_SLOPE = 0.1;  // cosine of the flattest angle that is looked at
  const double tolerance = 0.02 * model.diameter;
  const Eigen::Vector3d center = T_camera_object * model.center;
  // The camera's own direction of view does not matter to what hides what: one that looks at the part wastes no pixels.
  Pose T_look_camera = Pose::Identity();
  T_look_camera.linear() = Eigen::Quaterniond::FromTwoVectors(center, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Pose T_look_object = T_look_camera * T_camera_object;
  const double focal_length = 0.5 * SIZE * (center.norm() - 0.5 * model.diameter) / (0.55 * model.diameter);
  const PinholeCamera camera{focal_length, focal_length, 0.5 * SIZE, 0.5 * SIZE};
  DepthRenderer renderer(SIZE, SIZE, camera);
  renderer.draw(model.mesh, T_look_object, 0);
  OrientedPoints seen;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Eigen::Vector3d p = T_look_object * points.points[i].cast<double>();
    const Eigen::Vector3d n = T_look_object.linear() * points.normals[i].cast<double>();
    const Eigen::Vector2d pixel = camera.project(p);
    const int u = static_cast<int>(std::lround(pixel.x()));
    const int v = static_cast<int>(std::lround(pixel.y()));
    if (-n.dot(p.normalized()) < MIN_SLOPE || u < 0 || v < 0 || u >= SIZE || v >= SIZE)
      continue;
    if (p.z() > static_cast<double>(renderer.depth()[static_cast<std::size_t>(v * SIZE + u)]) + tolerance)
      continue;
    seen.points.push_back(points.points[i]);
    seen.normals.push_back(points.normals[i]);
  }
  return seen;
}

OrientedPoints nearPose(const OrientedPoints& scene, const PeerModel& model, const Pose& T_camera_object, double margin)
{
  const Pose T_object_camera = T_camera_object.inverse();
  const Eigen::Vector3d half = 0.5 * model.size + Eigen::Vector3d::Constant(margin);
  std::vector<int> inside;
  for (std::size_t i = 0; i < scene.size(); ++i)
    if (((T_object_camera * scene.points[i].cast<double>() - model.center).cwiseAbs() - half).maxCoeff() <= 0)
      inside.push_back(static_cast<int>(i));
  return select(scene, inside);
}

std::optional<Pose> nearestRigid(const Eigen::Matrix4d& matrix)
{
  if (!matrix.allFinite())
    return std::nullopt;
  const Eigen::Matrix3d turn = matrix.topLeftCorner<3, 3>();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(turn, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (turn.determinant() <= 0)
    return std::nullopt;
  Pose pose = Pose::Identity();
  pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  pose.translation() = matrix.topRightCorner<3, 1>();
  return pose;
}
}  // namespace bin_picking::peers
