// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace bin_picking
{
/// Depth of a pixel that was not measured: sorted last, near to none, and nothing when it is weighted with 0.
constexpr float NOT_MEASURED = std::numeric_limits<float>::max();

/// What the rows of pixels of a row of blocks add up to, for each column of pixels.
struct Columns
{
  explicit Columns(std::size_t width)
  {
    for (auto* plane : {&x, &y, &z, &count, &near, &far})
      plane->resize(width);
  }
  void clear()
  {
    for (auto* plane : {&x, &y, &z, &count, &far})
      std::fill(plane->begin(), plane->end(), 0.0f);
    std::fill(near.begin(), near.end(), NOT_MEASURED);
  }

  std::vector<float> x, y, z;  ///< sums over the measured pixels
  std::vector<float> count;    ///< of measured pixels
  std::vector<float> near;     ///< smallest depth
  std::vector<float> far;      ///< largest depth
};

/// The same for whole blocks.
using Blocks = Columns;

/// Depths that lie on one surface: at most so far from its median.
struct DepthLimit
{
  float depth;
  float per_depth;

  float at(float median) const { return depth + per_depth * median; }
};

/// Adds a row of pixels, column by column; what is no measurement counts nothing. \param step floats from one pixel to
/// the next
void addPixels(const float* x, const float* y, const float* z, std::size_t step, std::size_t count, Columns& columns);

/// The sums of every `factor` neighbouring columns: those of the blocks.
void joinColumns(const Columns& columns, std::size_t factor, Blocks& blocks);

/// Means of blocks that have the pixels that they need, NaN for others. \param mixed set where not all pixels lie
/// within the limit of whatever their median is: the mean is not that of one surface
void averageBlocks(const Blocks& blocks, const std::vector<float>& required, const DepthLimit& limit, float* x,
                   float* y, float* z, std::uint8_t* mixed);
}  // namespace bin_picking
