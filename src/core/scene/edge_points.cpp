// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/scene/edge_points.hpp"

#include <cmath>
#include <limits>

namespace bin_picking
{
namespace
{
constexpr int MAX_INWARD = 3;         // pixels from an edge to where the surface has a normal
constexpr float MIN_IN_PLANE = 0.9f;  // cosine between the edge's direction in the picture and in the surface

/// Of the surface that ends at the edge; NaN if none is near.
Eigen::Vector3f normalInside(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& normals, const DepthEdge& edge,
                             int row)
{
  Eigen::Vector3f normal = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  for (int k = 0; k <= MAX_INWARD && std::isnan(normal.x()); ++k)
  {
    const int u = edge.column - static_cast<int>(std::lround(static_cast<float>(k) * edge.outward.x()));
    const int v = row - static_cast<int>(std::lround(static_cast<float>(k) * edge.outward.y()));
    if (!grid.inside(u, v))
      break;
    normal = normals[static_cast<std::size_t>(grid.index(u, v))];
  }
  return normal;
}
}  // namespace

OrientedPoints edgePoints(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& normals, const DepthEdges& edges)
{
  OrientedPoints result;
  for (int v = 0; v < grid.height; ++v)
    for (const DepthEdge& edge : edges.rows[static_cast<std::size_t>(v)])
    {
      const Eigen::Vector3f normal = normalInside(grid, normals, edge, v);
      if (std::isnan(normal.x()))
        continue;
      const Eigen::Vector3f p = grid.point(grid.index(edge.column, v));
      const Eigen::Vector3f across = acrossRay(p, edge.outward);
      const Eigen::Vector3f in_surface = across - normal.dot(across) * normal;
      const float cosine = in_surface.norm();
      if (!(cosine > MIN_IN_PLANE))
        continue;
      const float half_pixel = 0.5f * static_cast<float>(grid.pitch(static_cast<double>(p.z())));
      const Eigen::Vector3f direction = in_surface / cosine;
      result.points.push_back(p + half_pixel / cosine * direction);
      result.normals.push_back(direction);
    }
  return result;
}
}  // namespace bin_picking
