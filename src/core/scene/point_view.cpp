// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/scene/point_view.hpp"

#include <algorithm>

namespace bin_picking
{
namespace
{
/// Every step-th pixel in both directions.
std::vector<int> measuredPixels(const PointView& points, int step)
{
  std::vector<int> pixels;
  for (int v = step / 2; v < points.height; v += step)
    for (int u = step / 2; u < points.width; u += step)
      if (points.measured(points.index(u, v)))
        pixels.push_back(points.index(u, v));
  return pixels;
}
}  // namespace

std::vector<int> measuredLattice(const PointView& points, int about)
{
  const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(points.size()) / about)));
  const std::vector<int> pixels = measuredPixels(points, step);
  constexpr std::size_t FEW = 8;  // a share of the picture so small that each pixel counts
  if (step == 1 || pixels.size() * FEW > static_cast<std::size_t>(about))
    return pixels;
  return measuredPixels(points, 1);
}

double medianDepth(const PointView& points)
{
  constexpr int ABOUT = 5000;
  std::vector<float> depths;
  for (const int i : measuredLattice(points, ABOUT))
    depths.push_back(points.point(i).z());
  if (depths.empty())
    return std::numeric_limits<double>::quiet_NaN();
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return static_cast<double>(*middle);
}

DepthGrid copyMeasured(const PointView& points)
{
  DepthGrid grid = makeGrid(points.width, points.height, points.camera);
  for (int i = 0; i < static_cast<int>(grid.size()); ++i)
  {
    if (!points.measured(i))
      continue;
    const Eigen::Vector3f p = points.point(i);
    const auto k = static_cast<std::size_t>(i);
    grid.x[k] = p.x();
    grid.y[k] = p.y();
    grid.z[k] = p.z();
  }
  return grid;
}
}  // namespace bin_picking
