// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "drop_placement.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/figures.hpp"

namespace bin_picking::simulation
{
namespace
{
constexpr int MAX_ATTITUDES = 200;  // a part that fits in so few of them that none is drawn is too large

double topBelow(const Eigen::AlignedBox2d& footprint, const DropSpace& space)
{
  double top = 0;
  for (const Eigen::AlignedBox3d& box : space.occupied)
    if (Eigen::AlignedBox2d(box.min().head<2>(), box.max().head<2>()).intersects(footprint))
      top = std::max(top, box.max().z());
  return top;
}

/// \param extent of the part in its attitude, about its centre of mass
Eigen::Vector3d placeAbove(const Eigen::AlignedBox3d& extent, const DropSpace& space, Random& random)
{
  Eigen::Vector2d place;
  for (int axis = 0; axis < 2; ++axis)
    place[axis] = random.uniform(-0.5 * space.inner_size[axis] - extent.min()[axis],
                                 0.5 * space.inner_size[axis] - extent.max()[axis]);
  const double top = topBelow({extent.min().head<2>() + place, extent.max().head<2>() + place}, space);
  return {place.x(), place.y(), top + space.clearance - extent.min().z()};
}
}  // namespace

Pose randomDrop(const BulletShape& shape, const DropSpace& space, Random& random)
{
  for (int k = 0; k < MAX_ATTITUDES; ++k)
  {
    Pose T_bin_body = Pose::Identity();
    T_bin_body.linear() = random.rotation().toRotationMatrix();
    Eigen::AlignedBox3d extent;
    for (const Eigen::Vector3d& corner : shape.corners)
      extent.extend(T_bin_body.linear() * corner);
    if ((extent.sizes().head<2>().array() >= space.inner_size.head<2>().array()).any())
      continue;
    T_bin_body.translation() = placeAbove(extent, space, random);
    return T_bin_body;
  }
  throw ParameterError("'" + shape.name + "' is too large for the bin: its farthest point is " +
                       millimetres(shape.radius, 0) + " from its centre of mass, and the bin is " +
                       millimetres(space.inner_size.x(), 0) + " x " + millimetres(space.inner_size.y(), 0) +
                       " inside; take a larger bin, or check the unit of the mesh");
}
}  // namespace bin_picking::simulation
