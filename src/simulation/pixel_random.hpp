// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "bin_picking_perception/common/parallel.hpp"

namespace bin_picking::simulation
{
/// Random numbers that are computed from the pixel, not drawn in turn: the same whoever asks, in whatever order.
class PixelRandom
{
public:
  static constexpr double MAX_NORMAL = 4.9;

  /// \param stream another one for every use within a scan
  PixelRandom(std::uint32_t seed, std::uint32_t stream);

  /// [0, 1). Pixels beside the picture, up to 2^15 away, have theirs too.
  double uniform(int u, int v) const { return static_cast<double>(hash(u, v, 0) >> 11) * 0x1p-53; }
  /// Mean 0, standard deviation 1: the sum of eight even numbers, so never beyond MAX_NORMAL.
  double normal(int u, int v) const;

private:
  std::uint64_t hash(int u, int v, std::uint64_t draw) const;

  std::uint64_t key_;
};

/// A picture of noise of mean 0 and standard deviation 1 whose autocorrelation is exp(-(distance / length)^2).
/// \param length pixels
std::vector<float> correlatedNoise(int width, int height, double length, const PixelRandom& random,
                                   const Executor& executor);

/// The same for great lengths, at a few points and in between interpolated: quick, and a little smoother.
std::vector<float> smoothNoise(int width, int height, double length, const PixelRandom& random,
                               const Executor& executor);
}  // namespace bin_picking::simulation
