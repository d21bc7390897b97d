// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "opposed_points.hpp"

#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/ray_triangle.hpp"

namespace bin_picking
{
namespace
{
struct Triangle
{
  Eigen::Vector3d corner, side_1, side_2, normal;
};

std::vector<Triangle> trianglesOf(const TriangleMesh& mesh)
{
  std::vector<Triangle> triangles;
  for (const auto& t : mesh.triangles)
  {
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>();
    const Eigen::Vector3d u = mesh.vertices[t[1]].cast<double>() - a, v = mesh.vertices[t[2]].cast<double>() - a;
    triangles.push_back({a, u, v, u.cross(v).normalized()});
  }
  return triangles;
}

bool nearlySame(const OpposedPoints& a, const OpposedPoints& b, double spacing)
{
  constexpr double SAME_AXIS = 0.966;  // cosine of 15 degrees
  return (a.middle - b.middle).norm() < spacing && std::abs(a.axis.dot(b.axis)) > SAME_AXIS;
}
}  // namespace

std::vector<OpposedPoints> opposedPoints(const TriangleMesh& mesh, double max_width, double max_angle, double spacing)
{
  constexpr double OFF_SURFACE = 1e-5;  // metres: what the ray starts from is not met
  const std::vector<Triangle> triangles = trianglesOf(mesh);
  const OrientedPoints samples = sampleSurface(mesh, spacing / 2, 1);
  std::vector<OpposedPoints> pairs;
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    const Eigen::Vector3d origin = samples.points[i].cast<double>();
    const Eigen::Vector3d inward = -samples.normals[i].cast<double>();
    for (const Triangle& triangle : triangles)
    {
      if (!(triangle.normal.dot(inward) > std::cos(max_angle)))
        continue;
      const auto width = crossing(triangle.corner, triangle.side_1, triangle.side_2, origin, inward);
      if (!width || *width < OFF_SURFACE || *width > max_width)
        continue;
      // Halfway between the two normals, both are inclined by the same.
      const OpposedPoints pair = {origin + *width / 2 * inward, (inward + triangle.normal).normalized(), *width};
      if (std::none_of(pairs.begin(), pairs.end(),
                       [&](const OpposedPoints& known) { return nearlySame(known, pair, spacing); }))
        pairs.push_back(pair);
    }
  }
  return pairs;
}
}  // namespace bin_picking
