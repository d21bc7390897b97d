// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "block_medians.hpp"

#include <cmath>

#include "../common/simd.hpp"

namespace bin_picking
{
namespace
{
constexpr std::size_t LANES = BlockMedians::LANES;
using Lanes = std::array<float, LANES>;
using Comparators = std::vector<std::pair<std::size_t, std::size_t>>;

/// Merge exchange (Knuth, The Art of Computer Programming 3, Algorithm 5.2.2 M): sorts any n values.
Comparators sortingNetwork(std::size_t n)
{
  Comparators network;
  std::size_t top = 1;
  while (2 * top < n)
    top *= 2;
  for (std::size_t p = top; p > 0; p /= 2)
  {
    std::size_t rest = 0;
    std::size_t distance = p;
    for (std::size_t q = top;; q /= 2)
    {
      for (std::size_t i = 0; i + distance < n; ++i)
        if ((i & p) == rest)
          network.emplace_back(i, i + distance);
      if (q == p)
        break;
      distance = q - p;
      rest = p;
    }
  }
  return network;
}

[[gnu::always_inline]] inline void exchange(float* __restrict low, float* __restrict high)
{
  for (std::size_t l = 0; l < LANES; ++l)
  {
    const float a = low[l];
    const float b = high[l];
    low[l] = a < b ? a : b;
    high[l] = a < b ? b : a;
  }
}

/// Median depth of each block. \param z the k-th pixels of all blocks, one k after the other \param sorted receives
/// them, sorted: missing pixels last
BIN_PICKING_SIMD void findMedians(const Comparators& network, const float* z, std::size_t pixels, float* sorted,
                                  Lanes& medians)
{
  Lanes count{};
  Lanes rank;
  for (std::size_t k = 0; k < pixels * LANES; k += LANES)
    for (std::size_t l = 0; l < LANES; ++l)
    {
      sorted[k + l] = z[k + l];
      count[l] += static_cast<float>(z[k + l] < NOT_MEASURED);
    }
  for (const auto& [first, second] : network)
    exchange(sorted + first * LANES, sorted + second * LANES);
  for (std::size_t l = 0; l < LANES; ++l)
    rank[l] = std::floor((count[l] - 1) / 2);
  for (std::size_t k = 0; 2 * k <= pixels; ++k)
    for (std::size_t l = 0; l < LANES; ++l)
      medians[l] = rank[l] == static_cast<float>(k) ? sorted[k * LANES + l] : medians[l];
}

struct Means
{
  Lanes x;
  Lanes y;
  Lanes z;
};

/// Means of what lies as near to the median as one surface may.
BIN_PICKING_SIMD void averageSurfaces(const float* x, const float* y, const float* z, std::size_t pixels,
                                      const Lanes& medians, const DepthLimit& given, Means& means)
{
  const DepthLimit limit = given;
  const Lanes median = medians;
  Means sum{};
  Lanes count{};
  for (std::size_t k = 0; k < pixels * LANES; k += LANES)
    for (std::size_t l = 0; l < LANES; ++l)
    {
      const auto weight = static_cast<float>(std::abs(z[k + l] - median[l]) <= limit.at(median[l]));
      sum.x[l] += weight * x[k + l];
      sum.y[l] += weight * y[k + l];
      sum.z[l] += weight * z[k + l];
      count[l] += weight;
    }
  for (std::size_t l = 0; l < LANES; ++l)
  {
    means.x[l] = sum.x[l] / count[l];
    means.y[l] = sum.y[l] / count[l];
    means.z[l] = sum.z[l] / count[l];
  }
}
}  // namespace

BlockMedians::BlockMedians(std::size_t pixels) : pixels_(pixels), network_(sortingNetwork(pixels))
{
  // A lane without a block is one of which nothing was measured.
  x_.resize(pixels * LANES);
  y_.resize(pixels * LANES);
  z_.resize(pixels * LANES, NOT_MEASURED);
  sorted_.resize(pixels * LANES);
}

void BlockMedians::average(const DepthLimit& limit)
{
  Lanes medians{};
  Means means;
  findMedians(network_, z_.data(), pixels_, sorted_.data(), medians);
  averageSurfaces(x_.data(), y_.data(), z_.data(), pixels_, medians, limit, means);
  mean_x_ = means.x;
  mean_y_ = means.y;
  mean_z_ = means.z;
}
}  // namespace bin_picking
