// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
DepthGrid makeGrid(int width, int height, const PinholeCamera& camera)
{
  DepthGrid grid;
  grid.width = width;
  grid.height = height;
  grid.camera = camera;
  const auto size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (auto* plane : {&grid.x, &grid.y, &grid.z})
    plane->assign(size, std::numeric_limits<float>::quiet_NaN());
  return grid;
}
}  // namespace bin_picking
