// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <vector>

namespace bin_picking::simulation
{
struct ConvexHull
{
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector4d> planes;  ///< (unit normal outwards, d): inside where n.p + d <= 0
  double volume = 0;

  bool contains(const Eigen::Vector3d& p) const;
};

/// The smallest convex body round the points; empty if they lie in a plane. Bullet rounds the points to a
/// ten-thousandth of their extent, so vertices may be off by that.
/// \param shrink faces are moved inwards by so much, metres, though by no more than half of the way to the middle
ConvexHull convexHull(const std::vector<Eigen::Vector3d>& points, double shrink = 0);

/// Few of the points, so that none of the others sticks out of their hull by more than the tolerance, metres.
std::vector<Eigen::Vector3d> simplifiedHull(const std::vector<Eigen::Vector3d>& points, double tolerance);
}  // namespace bin_picking::simulation
