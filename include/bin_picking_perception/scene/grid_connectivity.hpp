// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
class Executor;

/// When two neighbouring pixels lie on one surface: their depths differ by at most depth + slope * pitch, or the jump
/// continues the slope on both of its sides (a steep surface, not an edge). A fixed depth limit alone would cut every
/// surface that is steeper than about 35 degrees.
struct EdgeRule
{
  double depth = 0.001;  ///< metres
  double slope = 2.2;    ///< depth change per lateral step that is still a surface: 65 degrees
};

/// Per pixel, how many pixels one can go in each direction without crossing a depth edge or a missing pixel; counted up
/// to LONGEST, which is more than any neighbourhood needs.
struct ConnectedRuns
{
  static constexpr std::uint8_t LONGEST = 255;

  std::vector<std::uint8_t> left;
  std::vector<std::uint8_t> right;
  std::vector<std::uint8_t> up;
  std::vector<std::uint8_t> down;
};

ConnectedRuns connectedRuns(const DepthGrid& grid, const EdgeRule& rule, const Executor& executor);
}  // namespace bin_picking
