// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking
{
namespace test
{
/// The point of a segment that is nearest to p.
inline Eigen::Vector3d nearestOnSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b)
{
  const double t = (p - a).dot(b - a) / std::max((b - a).squaredNorm(), std::numeric_limits<double>::min());
  return a + std::min(std::max(t, 0.0), 1.0) * (b - a);
}

inline double distanceToTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                 const Eigen::Vector3d& c)
{
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const bool above = normal.dot((b - a).cross(p - a)) >= 0 && normal.dot((c - b).cross(p - b)) >= 0 &&
                     normal.dot((a - c).cross(p - c)) >= 0;
  if (above && normal.squaredNorm() > 0)
    return std::abs(normal.normalized().dot(p - a));
  return std::min({(nearestOnSegment(p, a, b) - p).norm(), (nearestOnSegment(p, b, c) - p).norm(),
                   (nearestOnSegment(p, c, a) - p).norm()});
}

/// The largest distance of a point to the surface, metres: every point against every triangle, but for those whose
/// bounding sphere is farther away than the nearest triangle found so far.
/// \param enough stop at the first distance above it
inline double largestSurfaceDistance(const std::vector<Eigen::Vector3f>& points, const TriangleMesh& mesh,
                                     double enough = std::numeric_limits<double>::infinity())
{
  struct Sphere
  {
    Eigen::Vector3d center;
    double radius;
  };
  std::vector<Sphere> spheres;
  for (const auto& t : mesh.triangles)
  {
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>();
    const Eigen::Vector3d b = mesh.vertices[t[1]].cast<double>();
    const Eigen::Vector3d c = mesh.vertices[t[2]].cast<double>();
    const Eigen::Vector3d center = (a + b + c) / 3;
    spheres.push_back({center, std::max({(a - center).norm(), (b - center).norm(), (c - center).norm()})});
  }
  double largest = 0;
  for (const Eigen::Vector3f& point : points)
  {
    const Eigen::Vector3d p = point.cast<double>();
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < spheres.size(); ++i)
    {
      const double reach = nearest + spheres[i].radius;
      if ((spheres[i].center - p).squaredNorm() >= reach * reach)
        continue;
      const auto& t = mesh.triangles[i];
      nearest =
          std::min(nearest, distanceToTriangle(p, mesh.vertices[t[0]].cast<double>(),
                                               mesh.vertices[t[1]].cast<double>(), mesh.vertices[t[2]].cast<double>()));
    }
    largest = std::max(largest, nearest);
    if (largest > enough)
      break;
  }
  return largest;
}
}  // namespace test
}  // namespace bin_picking
