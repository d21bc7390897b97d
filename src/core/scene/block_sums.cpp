// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "block_sums.hpp"

#include <cmath>

#include "../common/simd.hpp"
#include "bin_picking_perception/scene/point_view.hpp"

namespace bin_picking
{
namespace
{
[[gnu::always_inline]] inline void addRow(const float* from_x, const float* from_y, const float* from_z,
                                          std::size_t step, std::size_t count, float* __restrict x, float* __restrict y,
                                          float* __restrict z, float* __restrict pixels, float* __restrict near,
                                          float* __restrict far)
{
  constexpr float MAX = PointView::MAX_COORDINATE;
  for (std::size_t k = 0; k < count; ++k)
  {
    const float px = from_x[k * step];
    const float py = from_y[k * step];
    const float pz = from_z[k * step];
    const float aside = std::abs(px);
    const float down = std::abs(py);
    const bool measured = (aside <= MAX) & (down <= MAX) & (pz > 0) & (pz <= MAX);
    const float nearest = measured ? pz : NOT_MEASURED;
    const float furthest = measured ? pz : 0.0f;
    x[k] += measured ? px : 0.0f;
    y[k] += measured ? py : 0.0f;
    z[k] += furthest;
    pixels[k] += measured ? 1.0f : 0.0f;
    near[k] = nearest < near[k] ? nearest : near[k];
    far[k] = furthest > far[k] ? furthest : far[k];
  }
}

template <typename Operation>
[[gnu::always_inline]] inline void join(const std::vector<float>& of_columns, std::size_t factor, Operation operation,
                                        std::vector<float>& of_blocks)
{
  const float* from = of_columns.data();
  float* __restrict to = of_blocks.data();
  const std::size_t blocks = of_blocks.size();
  for (std::size_t b = 0; b < blocks; ++b)
  {
    float joined = from[b * factor];
    for (std::size_t k = 1; k < factor; ++k)
      joined = operation(joined, from[b * factor + k]);
    to[b] = joined;
  }
}

[[gnu::always_inline]] inline void joinAll(const Columns& columns, std::size_t factor, Blocks& blocks)
{
  const auto sum = [](float a, float b) { return a + b; };
  join(columns.x, factor, sum, blocks.x);
  join(columns.y, factor, sum, blocks.y);
  join(columns.z, factor, sum, blocks.z);
  join(columns.count, factor, sum, blocks.count);
  join(
      columns.near, factor, [](float a, float b) { return a < b ? a : b; }, blocks.near);
  join(
      columns.far, factor, [](float a, float b) { return a > b ? a : b; }, blocks.far);
}
}  // namespace

/// Vectors need the step as a constant: that of a grid's planes is 1, that of a PCL cloud's points is 4.
BIN_PICKING_SIMD void addPixels(const float* x, const float* y, const float* z, std::size_t step, std::size_t count,
                                Columns& columns)
{
  const auto add = [&](std::size_t constant) __attribute__((always_inline))
  {
    addRow(x, y, z, constant, count, columns.x.data(), columns.y.data(), columns.z.data(), columns.count.data(),
           columns.near.data(), columns.far.data());
  };
  step == 1 ? add(1) : step == 4 ? add(4) : add(step);
}

/// Vectors need the factor as a constant, so the common ones are.
BIN_PICKING_SIMD void joinColumns(const Columns& columns, std::size_t factor, Blocks& blocks)
{
  switch (factor)
  {
    case 2:
      return joinAll(columns, 2, blocks);
    case 3:
      return joinAll(columns, 3, blocks);
    case 4:
      return joinAll(columns, 4, blocks);
    case 5:
      return joinAll(columns, 5, blocks);
    case 6:
      return joinAll(columns, 6, blocks);
    default:
      return joinAll(columns, factor, blocks);
  }
}

BIN_PICKING_SIMD void averageBlocks(const Blocks& blocks, const std::vector<float>& required, const DepthLimit& given,
                                    float* __restrict x, float* __restrict y, float* __restrict z,
                                    std::uint8_t* __restrict mixed)
{
  const DepthLimit limit = given;
  const std::size_t size = required.size();
  for (std::size_t b = 0; b < size; ++b)
  {
    const float count = blocks.count[b];
    const bool enough = count >= required[b];
    const float scale = enough ? 1.0f : std::numeric_limits<float>::quiet_NaN();
    x[b] = scale * blocks.x[b] / count;
    y[b] = scale * blocks.y[b] / count;
    z[b] = scale * blocks.z[b] / count;
    const float spread = blocks.far[b] - blocks.near[b];
    const float of_one_surface = limit.at(blocks.near[b]);
    mixed[b] = enough & (spread > of_one_surface);
  }
}
}  // namespace bin_picking
