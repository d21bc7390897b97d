// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "fast_quantizer.hpp"

#include <algorithm>
#include <cmath>

namespace bin_picking
{
FastQuantizer::FastQuantizer(const FeatureQuantizer& quantizer)
    : inverse_step_(static_cast<float>(1 / quantizer.distance_step)),
      distance_bins_(quantizer.distance_bins),
      angle_bins_(quantizer.angle_bins)
{
  constexpr float BEYOND = -2;
  for (int i = 1; i < quantizer.angle_bins; ++i)
    limits_.push_back(static_cast<float>(std::cos(i * quantizer.angle_step)));
  limits_.push_back(BEYOND);
  for (int cell = 0; cell < CELLS; ++cell)
  {
    // The largest cosine of the cell gives its smallest bin.
    const double highest = std::min(1.0, (cell + 1) / (CELLS / 2 - 0.5) - 1);
    const auto bin = static_cast<int>(std::acos(highest) / quantizer.angle_step);
    first_bin_[static_cast<std::size_t>(cell)] =
        static_cast<std::int16_t>(std::max(0, std::min(bin, quantizer.angle_bins - 1) - 1));
  }
}

std::uint16_t turnFraction(float y, float x)
{
  // Octant by octant: atan(q) / 2 pi for q in [0, 1] by an odd polynomial of degree 7 (minimax fit; error 0.005
  // degrees).
  const float ax = std::abs(x);
  const float ay = std::abs(y);
  const float larger = std::max(ax, ay);
  const float q = larger > 0 ? std::min(ax, ay) / larger : 0;
  const float s = q * q;
  float turn = q * (0.15902992f + s * (-0.051117657f + s * (0.023281341f + s * -0.0062066667f)));
  if (ay > ax)
    turn = 0.25f - turn;
  if (x < 0)
    turn = 0.5f - turn;
  if (y < 0)
    turn = -turn;
  return static_cast<std::uint16_t>(static_cast<std::int32_t>(turn * 65536 + (turn < 0 ? -0.5f : 0.5f)) & 0xffff);
}
}  // namespace bin_picking
