// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
/// Pixels in which what lies within a ball is seen, looked at in steps.
struct PixelWindow
{
  /// Around a ball of radius `reach` (metres); empty behind the camera. \param max_pixels steps are so wide that at
  /// most about so many are looked at
  PixelWindow(const DepthGrid& grid, const Eigen::Vector3d& center, double reach, std::size_t max_pixels);

  int u_begin = 0;
  int u_end = 0;
  int v_begin = 0;
  int v_end = 0;
  int step = 1;
};
}  // namespace bin_picking
