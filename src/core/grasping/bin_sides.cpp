// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_sides.hpp"

namespace bin_picking
{
std::vector<BinSide> binSides(const Bin& bin)
{
  const double t = bin.wall_thickness;
  const Eigen::Vector3d inner = bin.inner_size;
  const Eigen::Vector3d outer = inner + Eigen::Vector3d(2 * t, 2 * t, 0);
  std::vector<BinSide> sides;
  const auto add = [&](const char* name, bool floor, const Eigen::Vector3d& center, const Eigen::Vector3d& size) {
    sides.push_back({name, floor, transformed(makeBox(center, size), bin.T_camera_bin),
                     Eigen::AlignedBox3d(center - 0.5 * size, center + 0.5 * size)});
  };
  const double x = 0.5 * (inner.x() + t);
  const double y = 0.5 * (inner.y() + t);
  const double z = 0.5 * inner.z();
  add("floor", true, {0, 0, -0.5 * t}, {outer.x(), outer.y(), t});
  add("wall at +x", false, {x, 0, z}, {t, outer.y(), inner.z()});
  add("wall at -x", false, {-x, 0, z}, {t, outer.y(), inner.z()});
  add("wall at +y", false, {0, y, z}, {outer.x(), t, inner.z()});
  add("wall at -y", false, {0, -y, z}, {outer.x(), t, inner.z()});
  return sides;
}
}  // namespace bin_picking
