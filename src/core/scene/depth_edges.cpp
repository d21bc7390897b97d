// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/scene/depth_edges.hpp"

#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"

namespace bin_picking
{
namespace
{
constexpr int HALF_WINDOW = 2;   // pixels; the direction of an edge is that to the middle of what lies beyond
constexpr int MAX_LOST_RIM = 4;  // pixels

class EdgeFinder
{
public:
  EdgeFinder(const DepthGrid& grid, const DepthGrid& surroundings, const ConnectedRuns& runs, double min_drop)
      : grid_(grid), surroundings_(surroundings), runs_(runs), min_drop_(static_cast<float>(min_drop))
  {}

  std::vector<DepthEdge> inRow(int v) const
  {
    std::vector<DepthEdge> edges;
    for (int u = 0; u < grid_.width; ++u)
    {
      const auto i = static_cast<std::size_t>(grid_.index(u, v));
      if (std::isnan(grid_.z[i]) ||
          (runs_.left[i] != 0 && runs_.right[i] != 0 && runs_.up[i] != 0 && runs_.down[i] != 0))
        continue;
      const Eigen::Vector2f beyond = towardsBeyond(u, v);
      const float length = beyond.norm();
      if (length > 0 && drops(u, v, beyond / length))
        edges.push_back({u, beyond / length});
    }
    return edges;
  }

private:
  /// Sum of the steps to the pixels around that do not belong to the surface.
  Eigen::Vector2f towardsBeyond(int u, int v) const
  {
    const float limit = grid_.z[static_cast<std::size_t>(grid_.index(u, v))] + min_drop_;
    Eigen::Vector2f sum = Eigen::Vector2f::Zero();
    for (int dv = -HALF_WINDOW; dv <= HALF_WINDOW; ++dv)
      for (int du = -HALF_WINDOW; du <= HALF_WINDOW; ++du)
        if (grid_.inside(u + du, v + dv) &&
            !(surroundings_.z[static_cast<std::size_t>(grid_.index(u + du, v + dv))] < limit))  // NaN: nothing there
          sum += Eigen::Vector2f(static_cast<float>(du), static_cast<float>(dv));
    return sum;
  }

  /// Whether the first measurement in the direction, beyond the pixel next to it, is far behind.
  bool drops(int u, int v, const Eigen::Vector2f& direction) const
  {
    const float limit = grid_.z[static_cast<std::size_t>(grid_.index(u, v))] + min_drop_;
    for (int k = 1; k <= MAX_LOST_RIM; ++k)
    {
      const int x = u + static_cast<int>(std::lround(static_cast<float>(k) * direction.x()));
      const int y = v + static_cast<int>(std::lround(static_cast<float>(k) * direction.y()));
      if (!grid_.inside(x, y))
        return false;
      const float z = surroundings_.z[static_cast<std::size_t>(grid_.index(x, y))];
      if (!std::isnan(z) && (k > 1 || z > limit))  // the next pixel may hold a mixture of both
        return z > limit;
    }
    return false;
  }

  const DepthGrid& grid_;
  const DepthGrid& surroundings_;
  const ConnectedRuns& runs_;
  float min_drop_;
};
}  // namespace

Eigen::Vector3f acrossRay(const Eigen::Vector3f& point, const Eigen::Vector2f& in_picture)
{
  const Eigen::Vector3f ray = point.normalized();
  const Eigen::Vector3f direction(in_picture.x(), in_picture.y(), 0);
  return (direction - ray.dot(direction) * ray).normalized();
}

DepthEdges findDepthEdges(const DepthGrid& grid, const DepthGrid& surroundings, const ConnectedRuns& runs,
                          double min_drop, const Executor& executor)
{
  const EdgeFinder finder(grid, surroundings, runs, min_drop);
  DepthEdges edges;
  edges.rows.resize(static_cast<std::size_t>(grid.height));
  constexpr std::size_t BAND = 16;  // rows per task
  executor.forEach((edges.rows.size() + BAND - 1) / BAND, [&](std::size_t band) {
    for (std::size_t v = band * BAND; v < std::min(edges.rows.size(), (band + 1) * BAND); ++v)
      edges.rows[v] = finder.inRow(static_cast<int>(v));
  });
  return edges;
}
}  // namespace bin_picking
