// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "sensor_scene.hpp"

#include <cmath>

#include "random.hpp"

namespace bin_picking::simulation
{
namespace
{
/// The inner bin, and the things in it: numbers, sizes.
struct SceneLayout
{
  Eigen::Vector3d bin;     // inner length, width, height
  double floor_depth = 0;  // from the camera
  double tilt = 0;         // of the camera, about x
  int num_boxes = 0;
  int num_cylinders = 0;
  double size = 0;    // of the longest edges
  double radius = 0;  // of the cylinders
};

SceneLayout layoutFor(SensorClass type)
{
  if (type == SensorClass::Stereo)
    return {{0.28, 0.2, 0.11}, 0.51, 0.03, 0, 14, 0.11, 0.021};
  return {{0.62, 0.4, 0.15}, 0.83, 0.1, 9, 7, 0.2, 0.03};
}

void addQuad(TriangleMesh& mesh, const Eigen::Vector3d& corner, const Eigen::Vector3d& a, const Eigen::Vector3d& b)
{
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Eigen::Vector3d& p :
       {corner, Eigen::Vector3d(corner + a), Eigen::Vector3d(corner + a + b), Eigen::Vector3d(corner + b)})
    mesh.vertices.push_back(p.cast<float>());
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

/// Floor at z = 0 and four walls that lean out by a tenth of their height, with rims.
std::shared_ptr<const TriangleMesh> makeBinMesh(const Eigen::Vector3d& inner)
{
  constexpr double LEAN = 0.15;
  constexpr double RIM = 0.015;
  auto mesh = std::make_shared<TriangleMesh>();
  const double x = 0.5 * inner.x();
  const double y = 0.5 * inner.y();
  const double h = inner.z();
  addQuad(*mesh, {-x, -y, 0}, {2 * x, 0, 0}, {0, 2 * y, 0});
  for (const double side : {-1.0, 1.0})
  {
    addQuad(*mesh, {side * x, -y - LEAN * h, 0}, {side * LEAN * h, 0, h}, {0, 2 * (y + LEAN * h), 0});
    addQuad(*mesh, {-x - LEAN * h, side * y, 0}, {0, side * LEAN * h, h}, {2 * (x + LEAN * h), 0, 0});
    addQuad(*mesh, {side * (x + LEAN * h), -y - LEAN * h, h}, {side * RIM, 0, 0}, {0, 2 * (y + LEAN * h), 0});
    addQuad(*mesh, {-x - LEAN * h, side * (y + LEAN * h), h}, {0, side * RIM, 0}, {2 * (x + LEAN * h), 0, 0});
  }
  return mesh;
}

std::shared_ptr<const TriangleMesh> makeBox(const Eigen::Vector3d& size)
{
  auto mesh = std::make_shared<TriangleMesh>();
  const Eigen::Vector3d half = 0.5 * size;
  const Eigen::Vector3d edges[3] = {{size.x(), 0, 0}, {0, size.y(), 0}, {0, 0, size.z()}};
  for (int axis = 0; axis < 3; ++axis)
  {
    addQuad(*mesh, -half, edges[(axis + 2) % 3], edges[(axis + 1) % 3]);
    addQuad(*mesh, -half + edges[axis], edges[(axis + 1) % 3], edges[(axis + 2) % 3]);
  }
  return mesh;
}

/// A tube along x, open at its ends.
std::shared_ptr<const TriangleMesh> makeTube(double length, double radius)
{
  constexpr int FACETS = 96;
  auto mesh = std::make_shared<TriangleMesh>();
  const auto rim = [&](int k) {
    const double angle = 2 * M_PI * k / FACETS;
    return Eigen::Vector3d(-0.5 * length, radius * std::cos(angle), radius * std::sin(angle));
  };
  for (int k = 0; k < FACETS; ++k)
    addQuad(*mesh, rim(k), {length, 0, 0}, rim(k + 1) - rim(k));
  return mesh;
}

/// Somewhere on the floor or on what lies there, any heading, a little tilted.
Pose randomRest(const SceneLayout& layout, double reach, double lowest, Random& random)
{
  Pose T_bin_object = Pose::Identity();
  const double x = 0.5 * layout.bin.x() - reach;
  const double y = 0.5 * layout.bin.y() - reach;
  T_bin_object.translation() << random.uniform(-x, x), random.uniform(-y, y),
      random.uniform(lowest, lowest + 0.45 * layout.bin.z());
  const Eigen::Vector3d tilt_axis(random.uniform(-1, 1), random.uniform(-1, 1), 0.01);
  T_bin_object.linear() = (Eigen::AngleAxisd(random.uniform(0, 0.3), tilt_axis.normalized()) *
                           Eigen::AngleAxisd(random.uniform(0, 2 * M_PI), Eigen::Vector3d::UnitZ()))
                              .toRotationMatrix();
  return T_bin_object;
}
}  // namespace

SensorParameters comparisonSensor(SensorClass type)
{
  SensorParameters parameters = sensorDefaults(type);
  const bool stereo = type == SensorClass::Stereo;
  parameters.width = stereo ? 302 : 516;
  parameters.height = stereo ? 200 : 386;
  const double focal_length = stereo ? 422.2 : 552.5;
  // Lengths in pixels are angles in truth: the real clouds have been reduced to every fourth pixel.
  const double scale = focal_length / cameraOf(sensorDefaults(type)).fx;
  parameters.noise.correlation_length *= scale;
  parameters.noise.bias_length *= scale;
  parameters.edges.loss_width *= scale;
  parameters.field_of_view = 2 * std::atan(0.5 * parameters.width / focal_length);
  return parameters;
}

std::vector<SceneObject> comparisonScene(SensorClass type, std::uint32_t seed)
{
  const SceneLayout layout = layoutFor(type);
  Pose T_camera_bin = Pose::Identity();
  T_camera_bin.linear() = Eigen::AngleAxisd(M_PI - layout.tilt, Eigen::Vector3d::UnitX()).toRotationMatrix();
  T_camera_bin.translation().z() = layout.floor_depth;
  std::vector<SceneObject> objects = {{makeBinMesh(layout.bin), T_camera_bin}};
  Random random(seed);
  for (int i = 0; i < layout.num_boxes; ++i)
  {
    const Eigen::Vector3d size(random.uniform(0.3, 1) * layout.size, random.uniform(0.3, 0.6) * layout.size,
                               random.uniform(0.1, 0.3) * layout.size);
    objects.push_back({makeBox(size), T_camera_bin * randomRest(layout, 0.4 * size.x(), 0.5 * size.z(), random)});
  }
  for (int i = 0; i < layout.num_cylinders; ++i)
  {
    const double length = random.uniform(0.6, 1) * layout.size;
    const double radius = random.uniform(0.8, 1) * layout.radius;
    objects.push_back({makeTube(length, radius), T_camera_bin * randomRest(layout, 0.4 * length, radius, random)});
  }
  return objects;
}
}  // namespace bin_picking::simulation
