// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

namespace bin_picking
{
/// Where a line goes through a triangle, in multiples of its direction from the origin (Moeller and Trumbore 1997);
/// nothing: it passes by, or along the triangle's plane.
/// \param side_1 from the corner to the second one \param side_2 to the third
inline std::optional<double> crossing(const Eigen::Vector3d& corner, const Eigen::Vector3d& side_1,
                                      const Eigen::Vector3d& side_2, const Eigen::Vector3d& origin,
                                      const Eigen::Vector3d& direction)
{
  const Eigen::Vector3d p = direction.cross(side_2);
  const double determinant = side_1.dot(p);
  if (std::abs(determinant) < 1e-18)
    return std::nullopt;
  const Eigen::Vector3d s = origin - corner;
  const double u = s.dot(p) / determinant;
  const Eigen::Vector3d q = s.cross(side_1);
  const double v = direction.dot(q) / determinant;
  if (u < 0 || v < 0 || u + v > 1)
    return std::nullopt;
  return side_2.dot(q) / determinant;
}
}  // namespace bin_picking
