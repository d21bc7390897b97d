// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/scene/grid_connectivity.hpp"

#include <algorithm>
#include <cmath>

#include "../common/simd.hpp"
#include "bin_picking_perception/common/parallel.hpp"

namespace bin_picking
{
namespace
{
constexpr std::size_t BAND = 32;  // rows per task
/// Share of a jump by which the slopes on its two sides may differ from it.
constexpr float SLOPE_TOLERANCE = 0.25f;

struct LinkRule
{
  float depth;
  float slope_per_depth;

  /// Whether the step from a to b stays on one surface.
  bool isFlat(float a, float b) const
  {
    return std::abs(b - a) <= depth + slope_per_depth * std::min(a, b);  // false for NaN
  }
  /// Whether it goes on at the slopes before and after it. Both must agree: a mixed pixel half-way down an edge has a
  /// flat surface on one side of each of its two jumps.
  bool continues(float before, float a, float b, float after) const
  {
    const float jump = b - a;
    const float limit = depth + SLOPE_TOLERANCE * std::abs(jump);
    return (std::abs(jump - (a - before)) <= limit) & (std::abs(jump - (after - b)) <= limit);
  }
};

/// links[k]: a[k] and b[k], neighbours in a row or column, lie on one surface.
BIN_PICKING_SIMD void linkAll(const float* before, const float* a, const float* b, const float* after,
                              std::size_t count, const LinkRule& given, std::uint8_t* links)
{
  const LinkRule rule = given;
  for (std::size_t k = 0; k < count; ++k)
    links[k] = static_cast<std::uint8_t>(rule.isFlat(a[k], b[k]) | rule.continues(before[k], a[k], b[k], after[k]));
}

/// The same at the border of the picture, where there is no slope to go on with.
void linkBorder(const float* a, const float* b, std::size_t count, const LinkRule& rule, std::uint8_t* links)
{
  for (std::size_t k = 0; k < count; ++k)
    links[k] = rule.isFlat(a[k], b[k]);
}

/// One more where linked, else none.
BIN_PICKING_SIMD void extendRuns(const std::uint8_t* links, const std::uint8_t* from, std::size_t count,
                                 std::uint8_t* to)
{
  for (std::size_t k = 0; k < count; ++k)
  {
    const int next = from[k] + (from[k] < ConnectedRuns::LONGEST);
    to[k] = static_cast<std::uint8_t>(links[k] != 0 ? next : 0);
  }
}

void runsOfRow(const float* z, std::size_t width, const LinkRule& rule, std::uint8_t* left, std::uint8_t* right)
{
  const auto more = [](std::uint8_t run) { return static_cast<std::uint8_t>(run + (run < ConnectedRuns::LONGEST)); };
  if (width < 2)
    return;
  linkBorder(z, z + 1, 1, rule, right);
  if (width > 3)
    linkAll(z, z + 1, z + 2, z + 3, width - 3, rule, right + 1);
  linkBorder(z + width - 2, z + width - 1, 1, rule, right + width - 2);
  for (std::size_t u = 0; u + 1 < width; ++u)
    left[u + 1] = right[u] != 0 ? more(left[u]) : std::uint8_t{0};
  for (std::size_t u = width - 1; u-- > 0;)
    right[u] = right[u] != 0 ? more(right[u + 1]) : std::uint8_t{0};
}
}  // namespace

ConnectedRuns connectedRuns(const DepthGrid& grid, const EdgeRule& rule, const Executor& executor)
{
  const LinkRule link{static_cast<float>(rule.depth), static_cast<float>(rule.slope * grid.pitch(1.0))};
  const auto w = static_cast<std::size_t>(grid.width);
  const auto h = static_cast<std::size_t>(grid.height);
  ConnectedRuns runs;
  for (auto* plane : {&runs.left, &runs.right, &runs.up, &runs.down})
    plane->assign(grid.size(), 0);
  executor.forEach((h + BAND - 1) / BAND, [&](std::size_t band) {
    for (std::size_t v = band * BAND; v < std::min(h, (band + 1) * BAND); ++v)
    {
      const float* z = grid.z.data() + v * w;
      runsOfRow(z, w, link, &runs.left[v * w], &runs.right[v * w]);
      if (v + 1 == h)
        continue;
      if (v > 0 && v + 2 < h)
        linkAll(z - w, z, z + w, z + 2 * w, w, link, &runs.down[v * w]);
      else
        linkBorder(z, z + w, w, link, &runs.down[v * w]);
    }
  });
  // `down` holds the links so far.
  for (std::size_t v = 0; v + 1 < h; ++v)
    extendRuns(&runs.down[v * w], &runs.up[v * w], w, &runs.up[(v + 1) * w]);
  for (std::size_t v = h; v-- > 1;)
    extendRuns(&runs.down[(v - 1) * w], &runs.down[v * w], w, &runs.down[(v - 1) * w]);
  return runs;
}
}  // namespace bin_picking
