// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "convex_hull.hpp"

#include <LinearMath/btConvexHullComputer.h>

#include <Eigen/Geometry>
#include <algorithm>

namespace bin_picking::simulation
{
namespace
{
constexpr double SHRINK_CLAMP = 0.5;

Eigen::Vector3d toEigen(const btVector3& v)
{
  return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

std::vector<Eigen::Vector3d> cornersOfFace(const btConvexHullComputer& hull, int face)
{
  std::vector<Eigen::Vector3d> corners;
  const btConvexHullComputer::Edge* const first = &hull.edges[hull.faces[face]];
  const btConvexHullComputer::Edge* edge = first;
  do
  {
    corners.push_back(toEigen(hull.vertices[edge->getSourceVertex()]));
    edge = edge->getNextEdgeOfFace();
  } while (edge != first);
  return corners;
}

/// The farthest points in the directions of the cube's faces, edges and corners: where a hull can begin.
std::vector<Eigen::Vector3d> extremes(const std::vector<Eigen::Vector3d>& points)
{
  std::vector<Eigen::Vector3d> result;
  for (const double z : {-1.0, 0.0, 1.0})
    for (const double y : {-1.0, 0.0, 1.0})
      for (const double x : {-1.0, 0.0, 1.0})
      {
        const Eigen::Vector3d direction(x, y, z);
        if (direction.isZero())
          continue;
        result.push_back(*std::max_element(points.begin(), points.end(), [&](const auto& a, const auto& b) {
          return direction.dot(a) < direction.dot(b);
        }));
      }
  return result;
}
}  // namespace

bool ConvexHull::contains(const Eigen::Vector3d& p) const
{
  return std::all_of(planes.begin(), planes.end(),
                     [&](const Eigen::Vector4d& plane) { return plane.head<3>().dot(p) + plane.w() <= 0; });
}

ConvexHull convexHull(const std::vector<Eigen::Vector3d>& points, double shrink)
{
  ConvexHull hull;
  btConvexHullComputer computer;
  const btScalar moved = computer.compute(points.empty() ? nullptr : points.front().data(), sizeof(Eigen::Vector3d),
                                          static_cast<int>(points.size()), static_cast<btScalar>(shrink),
                                          static_cast<btScalar>(SHRINK_CLAMP));
  if (moved < 0 || computer.faces.size() < 4)
    return hull;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (int i = 0; i < computer.vertices.size(); ++i)
    hull.vertices.push_back(toEigen(computer.vertices[i]));
  for (const Eigen::Vector3d& vertex : hull.vertices)
    middle += vertex / static_cast<double>(hull.vertices.size());
  for (int face = 0; face < computer.faces.size(); ++face)
  {
    const std::vector<Eigen::Vector3d> corners = cornersOfFace(computer, face);
    Eigen::Vector3d doubled_area = Eigen::Vector3d::Zero();
    for (std::size_t k = 2; k < corners.size(); ++k)
      doubled_area += (corners[k - 1] - corners[0]).cross(corners[k] - corners[0]);
    if (doubled_area.dot(corners[0] - middle) < 0)
      doubled_area = -doubled_area;
    if (doubled_area.norm() < 1e-14)
      continue;  // no area, no plane
    const Eigen::Vector3d normal = doubled_area.normalized();
    hull.planes.emplace_back(normal.x(), normal.y(), normal.z(), -normal.dot(corners[0]));
    hull.volume += doubled_area.dot(corners[0] - middle) / 6;
  }
  return hull;
}

std::vector<Eigen::Vector3d> simplifiedHull(const std::vector<Eigen::Vector3d>& points, double tolerance)
{
  std::vector<Eigen::Vector3d> kept = extremes(points);
  for (;;)
  {
    const ConvexHull hull = convexHull(kept);
    if (hull.planes.empty())
      return points;
    double farthest = tolerance;
    const Eigen::Vector3d* missing = nullptr;
    for (const Eigen::Vector4d& plane : hull.planes)
      for (const Eigen::Vector3d& point : points)
      {
        const double height = plane.head<3>().dot(point) + plane.w();
        if (height > farthest)
        {
          farthest = height;
          missing = &point;
        }
      }
    if (!missing)
      return hull.vertices;
    kept.push_back(*missing);
  }
}
}  // namespace bin_picking::simulation
