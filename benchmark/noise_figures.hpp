// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <array>

#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
/// What a cloud of unknown content tells about its sensor. NaN: too little of that kind in the cloud.
struct NoiseFigures
{
  double valid_share = 0;       ///< of all pixels
  double median_depth = 0;      ///< metres
  double small_tile_noise = 0;  ///< metres: deviation from planes of 12 x 12 pixels, median of the flattest quarter
  double large_tile_noise = 0;  ///< the same for 32 x 32 pixels: with the smooth errors
  double curved_noise = 0;      ///< deviation from quadrics of 12 x 12 pixels, median of the flatter half
  std::array<double, 4> correlation = {};  ///< of the deviations in the large tiles, 1, 2, 4 and 8 pixels apart
  double edge_gap = 0;                     ///< mean number of pixels lost between the two sides of a jump of depth
  double closed_edges = 0;                 ///< share of the jumps without any loss
  double mixed_pixels = 0;                 ///< pixels in between per jump
  double small_holes = 0;                  ///< share of the pixels that are lost in holes of at most 30 pixels
};

NoiseFigures noiseFigures(const DepthGrid& grid);
}  // namespace bin_picking
