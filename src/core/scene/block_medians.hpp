// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "block_sums.hpp"

namespace bin_picking
{
/// Means of one surface each, of blocks of pixels that see more than one: LANES blocks at a time, side by side. What is
/// the k-th pixel of each lies together, so that the median (a sorting network) and the mean are plain loops over the
/// lanes.
class BlockMedians
{
public:
  static constexpr std::size_t LANES = 32;

  /// \param pixels per block
  explicit BlockMedians(std::size_t pixels);

  /// Puts the k-th pixel of a block; one that was not measured is (0, 0, NOT_MEASURED).
  void set(std::size_t lane, std::size_t k, float x, float y, float z)
  {
    x_[k * LANES + lane] = x;
    y_[k * LANES + lane] = y;
    z_[k * LANES + lane] = z;
  }

  /// Finds the mean of what lies within the limit of each block's median depth. The lower median: two surfaces of the
  /// same size in a block are settled in favour of the nearer one.
  void average(const DepthLimit& limit);

  float x(std::size_t lane) const { return mean_x_[lane]; }
  float y(std::size_t lane) const { return mean_y_[lane]; }
  float z(std::size_t lane) const { return mean_z_[lane]; }

private:
  using Lanes = std::array<float, LANES>;

  std::size_t pixels_;
  std::vector<std::pair<std::size_t, std::size_t>> network_;  ///< places that are compared, in this order
  std::vector<float> x_, y_, z_, sorted_;
  Lanes mean_x_{};
  Lanes mean_y_{};
  Lanes mean_z_{};
};
}  // namespace bin_picking
