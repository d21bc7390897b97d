// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "triangle_distance.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace bin_picking::simulation
{
namespace
{
double squaredDistanceToSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b)
{
  const Eigen::Vector3d along = b - a;
  const double t = std::clamp((p - a).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
  return (a + t * along - p).squaredNorm();
}
}  // namespace

double squaredDistanceToTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                 const Eigen::Vector3d& c)
{
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const bool over = (b - a).cross(p - a).dot(normal) >= 0 && (c - b).cross(p - b).dot(normal) >= 0 &&
                    (a - c).cross(p - c).dot(normal) >= 0;
  if (over && normal.squaredNorm() > 0)
  {
    const double height = (p - a).dot(normal.normalized());
    return height * height;
  }
  return std::min(
      {squaredDistanceToSegment(p, a, b), squaredDistanceToSegment(p, b, c), squaredDistanceToSegment(p, c, a)});
}
}  // namespace bin_picking::simulation
