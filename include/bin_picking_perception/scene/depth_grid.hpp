// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace bin_picking
{
/// Pinhole camera: u = fx * x / z + cx, v = fy * y / z + cy; pixel centres at whole numbers.
struct PinholeCamera
{
  double fx = 0;
  double fy = 0;
  double cx = 0;
  double cy = 0;

  Eigen::Vector2d project(const Eigen::Vector3d& p) const { return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy}; }
  /// Point at depth z on the ray of pixel (u, v).
  Eigen::Vector3d backProject(double u, double v, double z) const { return {(u - cx) / fx * z, (v - cy) / fy * z, z}; }
};

/// An organized cloud as flat planes, row-major, in the camera's optical frame (z forward, x right, y down), metres.
/// Not measured = NaN in all three planes.
struct DepthGrid
{
  int width = 0;
  int height = 0;
  PinholeCamera camera;
  std::vector<float> x;
  std::vector<float> y;
  std::vector<float> z;

  std::size_t size() const { return z.size(); }
  int index(int u, int v) const { return v * width + u; }
  bool inside(int u, int v) const { return u >= 0 && v >= 0 && u < width && v < height; }
  bool valid(int i) const { return !std::isnan(z[static_cast<std::size_t>(i)]); }
  Eigen::Vector3f point(int i) const
  {
    const auto k = static_cast<std::size_t>(i);
    return {x[k], y[k], z[k]};
  }
  void invalidate(int i)
  {
    const auto k = static_cast<std::size_t>(i);
    x[k] = y[k] = z[k] = std::numeric_limits<float>::quiet_NaN();
  }
  /// Metres between neighbouring pixels at depth z.
  double pitch(double depth) const { return depth / std::sqrt(camera.fx * camera.fy); }
};

/// An all-invalid grid.
DepthGrid makeGrid(int width, int height, const PinholeCamera& camera);
}  // namespace bin_picking
