// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "bin_picking_perception/common/parallel.hpp"
#include "ray_scene.hpp"
#include "sensor.hpp"

namespace bin_picking::simulation
{
/// What a perfect camera would see, row-major.
struct SensorView
{
  int width = 0;
  int height = 0;
  PinholeCamera camera;
  std::vector<std::int32_t> labels;      ///< index of the object, -1: none
  std::vector<float> depth;              ///< z, metres; NaN: none
  std::vector<Eigen::Vector3f> normals;  ///< unit length, towards the camera

  std::size_t size() const { return labels.size(); }
  bool inside(int u, int v) const { return u >= 0 && v >= 0 && u < width && v < height; }
  std::size_t index(int u, int v) const
  {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u);
  }
  Eigen::Vector3d ray(int u, int v) const { return camera.backProject(u, v, 1); }
  Eigen::Vector3d point(int u, int v) const
  {
    return camera.backProject(u, v, static_cast<double>(depth[index(u, v)]));
  }
};

SensorView renderView(const RayScene& scene, const SensorParameters& parameters, const Executor& executor);

/// Pixels of every object: alone and visible; the measured ones are counted where `measured` has a depth.
std::vector<ObjectView> countPixels(const RayScene& scene, const std::vector<SceneObject>& objects,
                                    const SensorView& view, const DepthGrid& measured, const Executor& executor);
}  // namespace bin_picking::simulation
