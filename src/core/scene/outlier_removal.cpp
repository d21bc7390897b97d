// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"

namespace bin_picking
{
namespace
{
class NeighbourCount
{
public:
  NeighbourCount(const DepthGrid& grid, int window, double distance)
      : grid_(grid),
        window_(window),
        distance_(static_cast<float>(distance)),
        slope_per_depth_(static_cast<float>(EdgeRule().slope * grid.pitch(1.0)))
  {}

  /// Share of the pixels around (u, v), as far as they lie in the picture, whose depth is near.
  double share(int u, int v) const
  {
    const int u0 = std::max(0, u - window_);
    const int u1 = std::min(grid_.width - 1, u + window_);
    const int v0 = std::max(0, v - window_);
    const int v1 = std::min(grid_.height - 1, v + window_);
    const float z = grid_.z[static_cast<std::size_t>(grid_.index(u, v))];
    int near = -1;  // the pixel itself
    for (int row = v0; row <= v1; ++row)
    {
      const float* depths = &grid_.z[static_cast<std::size_t>(grid_.index(0, row))];
      for (int column = u0; column <= u1; ++column)
      {
        const int steps = std::max(std::abs(row - v), std::abs(column - u));
        near += std::abs(depths[column] - z) <= distance_ + slope_per_depth_ * z * static_cast<float>(steps);
      }
    }
    const int neighbours = (u1 - u0 + 1) * (v1 - v0 + 1) - 1;
    return neighbours == 0 ? 0.0 : static_cast<double>(near) / neighbours;
  }

private:
  const DepthGrid& grid_;
  int window_;
  float distance_;
  float slope_per_depth_;
};
}  // namespace

void removeOutliers(DepthGrid& grid, const PreprocessingParameters& parameters)
{
  if (parameters.outlier_window < 1)
    return;
  const NeighbourCount count(grid, parameters.outlier_window, parameters.outlier_distance);
  std::vector<int> outliers;  // removed together, so that the order of the pixels does not matter
  for (int v = 0; v < grid.height; ++v)
    for (int u = 0; u < grid.width; ++u)
      if (const int i = grid.index(u, v); grid.valid(i) && count.share(u, v) < parameters.outlier_min_share)
        outliers.push_back(i);
  for (const int i : outliers)
    grid.invalidate(i);
}
}  // namespace bin_picking
