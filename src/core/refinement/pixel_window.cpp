// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "pixel_window.hpp"

#include <algorithm>
#include <cmath>

namespace bin_picking
{
PixelWindow::PixelWindow(const DepthGrid& grid, const Eigen::Vector3d& center, double reach, std::size_t max_pixels)
{
  if (center.z() <= 0)
    return;
  const Eigen::Vector2d middle = grid.camera.project(center);
  const double radius = reach / grid.pitch(center.z());
  const auto bounded = [](double value, int count) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(count)));
  };
  u_begin = bounded(middle.x() - radius, grid.width);
  u_end = bounded(middle.x() + radius + 1, grid.width);
  v_begin = bounded(middle.y() - radius, grid.height);
  v_end = bounded(middle.y() + radius + 1, grid.height);
  step = std::max(1, static_cast<int>(std::ceil(2 * radius / std::sqrt(static_cast<double>(max_pixels)))));
}
}  // namespace bin_picking
