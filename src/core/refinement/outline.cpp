// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <limits>

#include "../common/rounding.hpp"
#include "bin_picking_perception/refinement/verification.hpp"

namespace bin_picking
{
namespace
{
/// The part's silhouette on a coarse raster: nearest depth per cell, infinity where it is not.
struct Raster
{
  int u0 = 0;
  int v0 = 0;
  int cell = 1;  ///< pixels
  int width = 0;
  int height = 0;
  std::vector<float> depth;

  std::size_t index(int x, int y) const
  {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }

  bool covered(int x, int y) const
  {
    return x >= 0 && y >= 0 && x < width && y < height && std::isfinite(depth[index(x, y)]);
  }
};

Raster rasterize(const std::vector<Eigen::Vector3f>& points, const PinholeCamera& camera, int cell)
{
  const Eigen::Vector2f focal = Eigen::Vector2d(camera.fx / cell, camera.fy / cell).cast<float>();
  const Eigen::Vector2f middle = Eigen::Vector2d(camera.cx / cell, camera.cy / cell).cast<float>();
  Raster raster;
  raster.cell = cell;
  std::vector<Eigen::Vector2i> cells;
  cells.reserve(points.size());
  Eigen::Vector2i low = Eigen::Vector2i::Constant(std::numeric_limits<int>::max());
  Eigen::Vector2i high = -low;
  for (const auto& p : points)
  {
    const Eigen::Vector2f place = focal.cwiseProduct(p.head<2>() / p.z()) + middle;
    cells.emplace_back(roundedDown(place.x()), roundedDown(place.y()));
    low = low.cwiseMin(cells.back());
    high = high.cwiseMax(cells.back());
  }
  raster.u0 = low.x();
  raster.v0 = low.y();
  raster.width = high.x() - low.x() + 1;
  raster.height = high.y() - low.y() + 1;
  raster.depth.assign(static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height),
                      std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    float& depth = raster.depth[raster.index(cells[i].x() - low.x(), cells[i].y() - low.y())];
    depth = std::min(depth, points[i].z());
  }
  return raster;
}
}  // namespace

OutlineEvidence gatherOutlineEvidence(const TrainedModel& model, const SurfaceIndices& visible,
                                      const Pose& T_camera_object, const DepthGrid& grid, double step, double tolerance)
{
  OutlineEvidence evidence;
  const Eigen::Isometry3f T = T_camera_object.cast<float>();
  std::vector<Eigen::Vector3f> points;
  points.reserve(visible.size());
  for (const std::uint32_t i : visible)
  {
    const Eigen::Vector3f p = T * model.surface.points[i];
    if (p.z() > 0)
      points.push_back(p);
  }
  if (points.empty())
    return evidence;
  const double depth = static_cast<double>(points.front().z());
  const Raster raster =
      rasterize(points, grid.camera, std::max(1, static_cast<int>(std::lround(step / grid.pitch(depth)))));

  constexpr int SIDES[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  for (int y = 0; y < raster.height; ++y)
    for (int x = 0; x < raster.width; ++x)
      for (const auto& side : SIDES)
      {
        // Two free cells beyond: one alone may be a gap between the points, or the blurred edge itself.
        if (!raster.covered(x, y) || raster.covered(x + side[0], y + side[1]) ||
            raster.covered(x + 2 * side[0], y + 2 * side[1]))
          continue;
        const int u = (raster.u0 + x + 2 * side[0]) * raster.cell + raster.cell / 2;
        const int v = (raster.v0 + y + 2 * side[1]) * raster.cell + raster.cell / 2;
        if (!grid.inside(u, v) || !grid.valid(grid.index(u, v)))
        {
          ++evidence.hidden;
          continue;
        }
        const double behind =
            static_cast<double>(grid.z[static_cast<std::size_t>(grid.index(u, v))] - raster.depth[raster.index(x, y)]);
        ++(behind > tolerance ? evidence.ends : behind < -tolerance ? evidence.hidden : evidence.continues);
      }
  return evidence;
}

std::vector<int> coveredCells(const std::vector<int>& pixels, int grid_width, int scale, int cell)
{
  constexpr int COLUMNS = 1 << 15;  // more than any sensor's, so that grids of different reduction share one numbering
  std::vector<int> cells;
  cells.reserve(pixels.size());
  for (const int pixel : pixels)
    cells.push_back(pixel / grid_width * scale / cell * COLUMNS + pixel % grid_width * scale / cell);
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}
}  // namespace bin_picking
