// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "bin_picking_perception/model/mesh.hpp"
#include "sensor.hpp"

namespace bin_picking
{
namespace test
{
constexpr int WIDTH = 200;
constexpr int HEIGHT = 160;

/// An exact sensor with a small picture and a narrow field; tests switch on the one effect that they are about.
inline simulation::SensorParameters exactSensor()
{
  simulation::SensorParameters parameters = simulation::sensorDefaults(simulation::SensorClass::Ideal);
  parameters.width = WIDTH;
  parameters.height = HEIGHT;
  parameters.field_of_view = 0.2;
  parameters.second_field_of_view = 2;
  return parameters;
}

/// A rectangle in x and y about the origin, seen from either side.
inline std::shared_ptr<const TriangleMesh> plate(float width, float height)
{
  auto mesh = std::make_shared<TriangleMesh>();
  const float x = width / 2;
  const float y = height / 2;
  mesh->vertices = {{-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0}};
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

inline Pose at(double x, double y, double z)
{
  Pose T_camera_object = Pose::Identity();
  T_camera_object.translation() << x, y, z;
  return T_camera_object;
}

inline Pose turnedAt(double angle, const Eigen::Vector3d& axis, double z)
{
  Pose T_camera_object = at(0, 0, z);
  T_camera_object.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  return T_camera_object;
}

/// A plate that fills the picture.
inline simulation::SceneObject wall(double z) { return {plate(4, 4), at(0, 0, z)}; }

inline DepthGrid gridOf(const simulation::SensorParameters& parameters,
                        const std::vector<simulation::SceneObject>& objects, std::uint32_t seed = 1)
{
  return simulation::VirtualSensor(parameters, 1).scan(objects, seed).grid;
}

inline double depthAt(const DepthGrid& grid, int u, int v)
{
  return static_cast<double>(grid.z[static_cast<std::size_t>(grid.index(u, v))]);
}

inline double validShare(const DepthGrid& grid)
{
  int count = 0;
  for (int i = 0; i < static_cast<int>(grid.size()); ++i)
    count += grid.valid(i) ? 1 : 0;
  return static_cast<double>(count) / static_cast<double>(grid.size());
}
}  // namespace test
}  // namespace bin_picking
