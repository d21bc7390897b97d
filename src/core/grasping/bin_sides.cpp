// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_sides.hpp"

#include <algorithm>
#include <limits>

namespace bin_picking
{
namespace
{
// As in convex_body.cpp: an edge along one of the box's has no cross product.
constexpr double MIN_CROSS_PRODUCT = 1e-9;

/// How far the corners reach along an axis, to either side.
struct Extent
{
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  Extent(const std::vector<Eigen::Vector3d>& corners, const Eigen::Vector3d& axis)
  {
    for (const Eigen::Vector3d& corner : corners)
    {
      const double along = axis.dot(corner);
      low = std::min(low, along);
      high = std::max(high, along);
    }
  }
};
}  // namespace

double clearance(const ConvexBody& body, const BinSide& side, const Pose& T_bin_camera)
{
  const Eigen::Matrix3d& turn = T_bin_camera.linear();
  const Eigen::Vector3d half = 0.5 * side.box_bin.sizes();
  const Eigen::Vector3d center = T_bin_camera.inverse() * side.box_bin.center();
  const auto halfExtent = [&](const Eigen::Vector3d& axis) { return half.dot((turn * axis).cwiseAbs()); };
  double clearance = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector4d& plane : body.planes)
    clearance =
        std::max(clearance, plane.head<3>().dot(center) + plane.w() - halfExtent(Eigen::Vector3d(plane.head<3>())));
  const auto separate = [&](const Eigen::Vector3d& axis, double half_extent) {
    const Extent extent(body.vertices, axis);
    const double middle = axis.dot(center);
    clearance = std::max({clearance, extent.low - middle - half_extent, middle - half_extent - extent.high});
  };
  for (int k = 0; k < 3; ++k)
    separate(turn.row(k), half[k]);
  for (const Eigen::Vector3d& edge : body.edges)
    for (int k = 0; k < 3; ++k)
    {
      const Eigen::Vector3d cross = edge.cross(turn.row(k).transpose());
      const double length = cross.norm();
      if (length < MIN_CROSS_PRODUCT)
        continue;
      const Eigen::Vector3d axis = cross / length;
      separate(axis, halfExtent(axis));
    }
  return clearance;
}

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
