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
    sides.push_back({name, floor, transformed(makeBox(center, size), bin.T_camera_bin)});
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

bool isWellInside(const ConvexBody& body, const Pose& T_bin_body, const Eigen::Vector3d& motion_bin, const Bin& bin,
                  double distance)
{
  Eigen::AlignedBox3d covered;
  for (const Eigen::Vector3d& v : body.vertices)
    covered.extend(T_bin_body * v);
  covered.extend(Eigen::AlignedBox3d(covered.min() + motion_bin, covered.max() + motion_bin));
  if (covered.min().z() >= bin.inner_size.z() + distance)
    return true;
  const Eigen::Array2d half = 0.5 * bin.inner_size.head<2>().array() - distance;
  return covered.min().z() >= distance && (covered.min().head<2>().array() >= -half).all() &&
         (covered.max().head<2>().array() <= half).all();
}
}  // namespace bin_picking
