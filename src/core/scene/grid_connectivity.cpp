// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/scene/grid_connectivity.hpp"

#include <algorithm>
#include <cmath>

namespace bin_picking
{
namespace
{
/// Share of a jump by which the slopes on its two sides may differ from it.
constexpr float SLOPE_TOLERANCE = 0.25f;

class LinkTest
{
public:
  LinkTest(const DepthGrid& grid, const EdgeRule& rule)
      : z_(grid.z.data()),
        depth_(static_cast<float>(rule.depth)),
        slope_per_depth_(static_cast<float>(rule.slope * grid.pitch(1.0)))
  {}

  /// Whether pixels i and i + step lie on one surface.
  /// \param before, after whether i - step and i + 2 step are pixels of the same row or column
  bool linked(std::size_t i, std::size_t step, bool before, bool after) const
  {
    const float a = z_[i];
    const float b = z_[i + step];
    const float jump = b - a;
    if (std::abs(jump) <= depth_ + slope_per_depth_ * std::min(a, b))
      return true;
    return before && after && continues(jump, a - z_[i - step]) && continues(jump, z_[i + 2 * step] - b);
  }

private:
  // Both sides must agree: a mixed pixel half-way down an edge has a flat surface on one side of each of its two jumps.
  bool continues(float jump, float slope) const
  {
    return std::abs(jump - slope) <= depth_ + SLOPE_TOLERANCE * std::abs(jump);
  }

  const float* z_;
  float depth_;
  float slope_per_depth_;
};

std::uint16_t nextRun(std::uint16_t run)
{
  return run == std::numeric_limits<std::uint16_t>::max() ? run : static_cast<std::uint16_t>(run + 1);
}
}  // namespace

ConnectedRuns connectedRuns(const DepthGrid& grid, const EdgeRule& rule)
{
  const LinkTest test(grid, rule);
  const auto w = static_cast<std::size_t>(grid.width);
  const auto h = static_cast<std::size_t>(grid.height);
  ConnectedRuns runs;
  for (auto* plane : {&runs.left, &runs.right, &runs.up, &runs.down})
    plane->assign(grid.size(), 0);
  for (std::size_t v = 0; v < h; ++v)
  {
    for (std::size_t u = 0; u < w; ++u)
    {
      const std::size_t i = v * w + u;
      if (u + 1 < w && test.linked(i, 1, u > 0, u + 2 < w))
        runs.left[i + 1] = nextRun(runs.left[i]);
      if (v + 1 < h && test.linked(i, w, v > 0, v + 2 < h))
        runs.up[i + w] = nextRun(runs.up[i]);
    }
  }
  for (std::size_t i = grid.size(); i-- > 0;)
  {
    if ((i + 1) % w != 0 && runs.left[i + 1] > 0)
      runs.right[i] = nextRun(runs.right[i + 1]);
    if (i + w < grid.size() && runs.up[i + w] > 0)
      runs.down[i] = nextRun(runs.down[i + w]);
  }
  return runs;
}

double medianDepth(const DepthGrid& grid)
{
  std::vector<float> depths;
  depths.reserve(grid.size());
  for (const float z : grid.z)
    if (!std::isnan(z))
      depths.push_back(z);
  if (depths.empty())
    return std::numeric_limits<double>::quiet_NaN();
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return static_cast<double>(*middle);
}
}  // namespace bin_picking
