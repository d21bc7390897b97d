// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/model/mesh.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"
#include "sensor_parameters.hpp"

namespace bin_picking::simulation
{
/// A mesh somewhere in front of the camera. Meshes are told apart by address: objects that share one share its memory.
struct SceneObject
{
  std::shared_ptr<const TriangleMesh> mesh;
  Pose T_camera_object = Pose::Identity();
};

/// How much of an object the camera sees, counted in pixels of the ideal picture (no noise, no loss).
struct ObjectView
{
  int pixels_alone = 0;         ///< its silhouette if nothing else were there, cut at the picture's edge
  int visible_pixels = 0;       ///< of these, where no other object is in front
  int valid_pixels = 0;         ///< of these, where the sensor measured something
  double visible_fraction = 0;  ///< visible_pixels / pixels_alone, [0, 1] (BOP's visib_fract); 0 where none
};

/// One exposure.
struct Scan
{
  DepthGrid grid;                    ///< as measured; its camera is the true one
  std::vector<std::int32_t> labels;  ///< per pixel the index of the object that is truly seen there; -1: none
  std::vector<ObjectView> views;     ///< per object, in the order given
};

/// A 3D sensor: a pinhole camera at the origin of the optical frame (x right, y down, z forward) and, `baseline` beside
/// it along +x, the projector or the second camera without which there is no depth.
class VirtualSensor
{
public:
  /// \param num_threads as Executor's; the result does not depend on it
  /// \throws ParameterError a parameter is out of its range
  explicit VirtualSensor(const SensorParameters& parameters, int num_threads = 0);
  ~VirtualSensor();
  VirtualSensor(VirtualSensor&&) noexcept;
  VirtualSensor& operator=(VirtualSensor&&) noexcept;

  /// What the sensor measures. The same objects and seed give the same bits. Not thread-safe: one scan at a time (the
  /// search structures of meshes are kept from scan to scan).
  /// \param seed of the noise; another exposure of the same scene takes another
  Scan scan(const std::vector<SceneObject>& objects, std::uint32_t seed);

  PinholeCamera camera() const;
  const SensorParameters& parameters() const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace bin_picking::simulation
