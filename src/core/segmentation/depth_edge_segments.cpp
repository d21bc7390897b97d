// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "depth_edge_segments.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "distance_map.hpp"

namespace bin_picking
{
namespace
{
constexpr double EDGE_SLOPE = 1.5;  // 56 degrees; steeper continuous surfaces are recognised by the slope on both sides
constexpr int MAX_HOLE = 3;         // pixels
constexpr int MIN_SEGMENT_PIXELS = 12;  // smaller ones are specks of noise
constexpr float LEVELS_PER_PIXEL = 16;  // resolution of the distance that orders the growth

/// Bridges runs of at most MAX_HOLE missing pixels between near depths, so that a missing pixel does not act as an
/// edge.
void fillHoles(std::vector<float>& depth, std::size_t begin, std::size_t step, std::size_t count, float edge_depth)
{
  std::size_t last = count;  // none yet
  for (std::size_t k = 0; k < count; ++k)
  {
    const float z = depth[begin + k * step];
    if (std::isnan(z))
      continue;
    const std::size_t hole = last < count ? k - last - 1 : 0;
    const float previous = last < count ? depth[begin + last * step] : z;
    if (hole > 0 && hole <= MAX_HOLE && std::abs(z - previous) <= edge_depth)
      for (std::size_t m = 1; m <= hole; ++m)
        depth[begin + (last + m) * step] =
            previous + (z - previous) * static_cast<float>(m) / static_cast<float>(hole + 1);
    last = k;
  }
}

DepthGrid withoutSmallHoles(const DepthGrid& grid, double edge_depth)
{
  DepthGrid filled = grid;
  const auto w = static_cast<std::size_t>(grid.width);
  const auto h = static_cast<std::size_t>(grid.height);
  for (std::size_t v = 0; v < h; ++v)
    fillHoles(filled.z, v * w, 1, w, static_cast<float>(edge_depth));
  for (std::size_t u = 0; u < w; ++u)
    fillHoles(filled.z, u, w, h, static_cast<float>(edge_depth));
  return filled;
}

/// White where a pixel is connected to all its neighbours within the picture.
cv::Mat interior(const DepthGrid& grid, const ConnectedRuns& runs)
{
  cv::Mat mask(grid.height, grid.width, CV_8U);
  for (int v = 0; v < grid.height; ++v)
  {
    for (int u = 0; u < grid.width; ++u)
    {
      const auto i = static_cast<std::size_t>(grid.index(u, v));
      const bool inside = !std::isnan(grid.z[i]) && (u == 0 || runs.left[i] > 0) && (v == 0 || runs.up[i] > 0) &&
                          (u + 1 == grid.width || runs.right[i] > 0) && (v + 1 == grid.height || runs.down[i] > 0);
      mask.at<std::uint8_t>(v, u) = inside ? 255 : 0;
    }
  }
  return mask;
}

/// Measured pixels by falling distance, equal ones in the order of the picture.
std::vector<int> growthOrder(const DepthGrid& grid, const std::vector<int>& level)
{
  const int top = level.empty() ? 0 : *std::max_element(level.begin(), level.end());
  std::vector<int> begin(static_cast<std::size_t>(top) + 2, 0);
  for (std::size_t i = 0; i < level.size(); ++i)
    begin[static_cast<std::size_t>(top - level[i]) + 1] += !std::isnan(grid.z[i]);
  for (std::size_t k = 1; k < begin.size(); ++k)
    begin[k] += begin[k - 1];
  std::vector<int> order(static_cast<std::size_t>(begin.back()));
  for (std::size_t i = 0; i < level.size(); ++i)
    if (!std::isnan(grid.z[i]))
      order[static_cast<std::size_t>(begin[static_cast<std::size_t>(top - level[i])]++)] = static_cast<int>(i);
  return order;
}

/// Basins that grow downwards from the maxima of the distance and may join (union-find).
class Basins
{
public:
  explicit Basins(double neck) : neck_(neck) {}

  int add(int peak)
  {
    parent_.push_back(static_cast<int>(parent_.size()));
    peak_.push_back(peak);
    return parent_.back();
  }

  int root(int basin)
  {
    while (parent_[static_cast<std::size_t>(basin)] != basin)
    {
      int& parent = parent_[static_cast<std::size_t>(basin)];
      parent = parent_[static_cast<std::size_t>(parent)];
      basin = parent;
    }
    return basin;
  }

  /// Two basins meet at a level: they join unless the passage is a neck of the lower one. Returns the higher basin.
  int meet(int a, int b, int level)
  {
    const auto peak = [&](int basin) { return peak_[static_cast<std::size_t>(basin)]; };
    const bool a_is_higher = peak(a) > peak(b) || (peak(a) == peak(b) && a < b);
    const int higher = a_is_higher ? a : b;
    const int lower = a_is_higher ? b : a;
    if (level >= neck_ * peak(lower))
      parent_[static_cast<std::size_t>(lower)] = higher;
    return higher;
  }

private:
  double neck_;
  std::vector<int> parent_;
  std::vector<int> peak_;
};

/// Basin of each pixel, -1 where there is no depth.
std::vector<int> grow(const DepthGrid& grid, const ConnectedRuns& runs, const std::vector<int>& level, Basins& basins)
{
  std::vector<int> basin_of(grid.size(), -1);
  for (const int pixel : growthOrder(grid, level))
  {
    const auto i = static_cast<std::size_t>(pixel);
    const std::array<int, 4> neighbours = {runs.left[i] > 0 ? pixel - 1 : -1, runs.right[i] > 0 ? pixel + 1 : -1,
                                           runs.up[i] > 0 ? pixel - grid.width : -1,
                                           runs.down[i] > 0 ? pixel + grid.width : -1};
    int best = -1;
    for (const int n : neighbours)
    {
      if (n < 0 || basin_of[static_cast<std::size_t>(n)] < 0)
        continue;
      const int other = basins.root(basin_of[static_cast<std::size_t>(n)]);
      best = best < 0 || best == other ? other : basins.meet(best, other, level[i]);
    }
    basin_of[i] = best < 0 ? basins.add(level[i]) : best;
  }
  return basin_of;
}

/// Numbers the basins in the order of the picture; pixels that were only filled in and specks get no number.
std::vector<std::int32_t> numbered(const DepthGrid& measured, std::vector<int> basin_of, Basins& basins)
{
  std::vector<int> pixels;
  for (std::size_t i = 0; i < basin_of.size(); ++i)
  {
    if (basin_of[i] < 0 || std::isnan(measured.z[i]))
    {
      basin_of[i] = -1;
      continue;
    }
    basin_of[i] = basins.root(basin_of[i]);
    pixels.resize(std::max(pixels.size(), static_cast<std::size_t>(basin_of[i]) + 1), 0);
    ++pixels[static_cast<std::size_t>(basin_of[i])];
  }
  std::vector<std::int32_t> number(pixels.size(), 0);
  std::vector<std::int32_t> labels(basin_of.size(), 0);
  std::int32_t count = 0;
  for (std::size_t i = 0; i < basin_of.size(); ++i)
  {
    if (basin_of[i] < 0 || pixels[static_cast<std::size_t>(basin_of[i])] < MIN_SEGMENT_PIXELS)
      continue;
    std::int32_t& own = number[static_cast<std::size_t>(basin_of[i])];
    if (own == 0)
      own = ++count;
    labels[i] = own;
  }
  return labels;
}
}  // namespace

std::vector<std::int32_t> depthEdgeSegments(const DepthGrid& grid, double edge_depth, double neck,
                                            const Executor& executor)
{
  if (grid.size() == 0)
    return {};
  const DepthGrid filled = withoutSmallHoles(grid, edge_depth);
  const ConnectedRuns runs = connectedRuns(filled, {edge_depth, EDGE_SLOPE}, executor);
  const cv::Mat distance = distanceToBlack(interior(filled, runs));
  std::vector<int> level(grid.size());
  std::transform(distance.begin<float>(), distance.end<float>(), level.begin(),
                 [](float d) { return cvRound(d * LEVELS_PER_PIXEL); });
  Basins basins(neck);
  const std::vector<int> basin_of = grow(filled, runs, level, basins);
  return numbered(grid, basin_of, basins);
}
}  // namespace bin_picking
