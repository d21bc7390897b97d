// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
/// Organized points where they lie, not copied: point by point as in a PCL cloud, or plane by plane as in a grid. What
/// it looks at must outlive it.
struct PointView
{
  PointView() = default;
  /// Not explicit: whatever takes a view takes a grid.
  PointView(const DepthGrid& grid)
      : width(grid.width),
        height(grid.height),
        camera(grid.camera),
        x(grid.x.data()),
        y(grid.y.data()),
        z(grid.z.data())
  {}

  /// Larger values are fill values of drivers, not measurements; far above any depth in micrometres.
  static constexpr float MAX_COORDINATE = 1e6f;

  std::size_t size() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  int index(int u, int v) const { return v * width + u; }
  Eigen::Vector3f point(int i) const
  {
    const std::size_t k = static_cast<std::size_t>(i) * step;
    return {x[k], y[k], z[k]};
  }
  /// NaN, infinity, fill values and what lies behind the camera are no measurements, nor is (0, 0, 0).
  bool measured(int i) const
  {
    const Eigen::Vector3f p = point(i);
    return p.z() > 0 && p.cwiseAbs().maxCoeff() <= MAX_COORDINATE;
  }
  /// Metres between neighbouring pixels at a depth.
  double pitch(double depth) const { return depth / std::sqrt(camera.fx * camera.fy); }

  int width = 0;
  int height = 0;
  PinholeCamera camera;
  const float* x = nullptr;
  const float* y = nullptr;
  const float* z = nullptr;
  std::size_t step = 1;  ///< floats from one point to the next
};

/// Indices of measured pixels spread evenly over the picture: about as many as asked for where all are measured, all
/// that there are where there are few.
std::vector<int> measuredLattice(const PointView& points, int about);

/// Median depth of the measured pixels, of a lattice of them where there are many; metres, NaN if there are none.
double medianDepth(const PointView& points);

/// The points as a grid; what is not measured becomes NaN.
DepthGrid copyMeasured(const PointView& points);
}  // namespace bin_picking
