// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <cmath>

#include "bin_picking_perception/scene/cloud_input.hpp"

namespace bin_picking
{
namespace
{
bool withinLimits(const Eigen::Vector3d& p, const InputParameters& limits)
{
  return p.x() >= limits.x_min && p.x() <= limits.x_max && p.y() >= limits.y_min && p.y() <= limits.y_max &&
         p.z() >= limits.z_min && p.z() <= limits.z_max;
}

/// Above the floor and between the walls; a heap may stand out above the rim.
bool withinBin(const Eigen::Vector3d& p_bin, const Bin& bin, const InputParameters& limits)
{
  return p_bin.z() >= limits.bin_floor_margin &&
         std::abs(p_bin.x()) <= bin.inner_size.x() / 2 - limits.bin_wall_margin &&
         std::abs(p_bin.y()) <= bin.inner_size.y() / 2 - limits.bin_wall_margin;
}
}  // namespace

void cropToRegion(DepthGrid& grid, const InputParameters& parameters, const Bin* bin)
{
  const Pose T_bin_camera = bin ? bin->T_camera_bin.inverse() : Pose::Identity();
  for (int i = 0; i < static_cast<int>(grid.size()); ++i)
  {
    if (!grid.valid(i))
      continue;
    const Eigen::Vector3d p = grid.point(i).cast<double>();
    if (!withinLimits(p, parameters) || (bin && !withinBin(T_bin_camera * p, *bin, parameters)))
      grid.invalidate(i);
  }
}
}  // namespace bin_picking
