// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "../common/simd.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"

namespace bin_picking
{
namespace
{
constexpr int BAND = 16;  // rows per task

/// Adds to count[k] whether depth other[k] is near depth own[k].
BIN_PICKING_SIMD void countNear(const float* own, const float* other, int size, float distance, float slope_per_depth,
                                float* count)
{
  for (int k = 0; k < size; ++k)
    count[k] += std::abs(other[k] - own[k]) <= distance + slope_per_depth * own[k] ? 1.0f : 0.0f;
}

class NeighbourCount
{
public:
  NeighbourCount(const DepthGrid& grid, int window, double distance)
      : grid_(grid),
        window_(window),
        distance_(static_cast<float>(distance)),
        slope_per_depth_(static_cast<float>(EdgeRule().slope * grid.pitch(1.0)))
  {}

  /// Share of the pixels around it, as far as they lie in the picture, whose depth is near; of each pixel of a row from
  /// u0 up to u1.
  void shares(int v, int u0, int u1, std::vector<float>& share) const
  {
    const int v0 = std::max(0, v - window_);
    const int v1 = std::min(grid_.height - 1, v + window_);
    share.assign(static_cast<std::size_t>(grid_.width), -1.0f);  // the pixel itself
    for (int row = v0; row <= v1; ++row)
    {
      for (int step = -window_; step <= window_; ++step)
      {
        const int begin = std::max(u0, -step);
        const int size = std::min(u1, grid_.width - step) - begin;
        const auto steps = static_cast<float>(std::max(std::abs(row - v), std::abs(step)));
        if (size > 0)
          countNear(depths(begin, v), depths(begin + step, row), size, distance_, slope_per_depth_ * steps,
                    &share[static_cast<std::size_t>(begin)]);
      }
    }
    for (int u = u0; u < u1; ++u)
    {
      const int columns = std::min(grid_.width - 1, u + window_) - std::max(0, u - window_) + 1;
      const int neighbours = columns * (v1 - v0 + 1) - 1;
      share[static_cast<std::size_t>(u)] /= static_cast<float>(std::max(1, neighbours));
    }
  }

private:
  const float* depths(int u, int v) const { return &grid_.z[static_cast<std::size_t>(grid_.index(u, v))]; }

  const DepthGrid& grid_;
  int window_;
  float distance_;
  float slope_per_depth_;
};
}  // namespace

void removeOutliers(DepthGrid& grid, const PreprocessingParameters& parameters, const Executor& executor)
{
  if (parameters.outlier_window < 1)
    return;
  const NeighbourCount count(grid, parameters.outlier_window, parameters.outlier_distance);
  const auto min_share = static_cast<float>(parameters.outlier_min_share);
  const auto num_bands = static_cast<std::size_t>((grid.height + BAND - 1) / BAND);
  std::vector<std::vector<int>> outliers(num_bands);  // removed together, so that the order does not matter
  executor.forEach(num_bands, [&](std::size_t band) {
    std::vector<float> share;
    const int begin = static_cast<int>(band) * BAND;
    for (int v = begin; v < std::min(grid.height, begin + BAND); ++v)
    {
      int u0 = 0;
      int u1 = grid.width;
      while (u0 < u1 && !grid.valid(grid.index(u0, v)))
        ++u0;
      while (u1 > u0 && !grid.valid(grid.index(u1 - 1, v)))
        --u1;
      count.shares(v, u0, u1, share);
      for (int u = u0; u < u1; ++u)
        if (share[static_cast<std::size_t>(u)] < min_share && grid.valid(grid.index(u, v)))
          outliers[band].push_back(grid.index(u, v));
    }
  });
  for (const auto& of_band : outliers)
    for (const int i : of_band)
      grid.invalidate(i);
}
}  // namespace bin_picking
