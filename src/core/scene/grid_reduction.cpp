// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "../common/simd.hpp"
#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"

// Blocks are reduced LANES at a time, side by side: what is the k-th pixel of each block lies together, so that the
// median (a sorting network) and the mean are plain loops over the lanes.

namespace bin_picking
{
namespace
{
/// A block with fewer measured pixels than one in this many stays empty, so that stray pixels do not spread.
constexpr int MIN_BLOCK_SHARE = 4;
constexpr std::size_t LANES = 64;
/// Depth of a pixel that was not measured: sorted last, near to none, and nothing when it is weighted with 0.
constexpr float NOTHING = std::numeric_limits<float>::max();

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

/// Working memory of LANES blocks of factor x factor pixels; what belongs to one pixel position lies together.
struct Lanes
{
  explicit Lanes(int factor) : pixels(static_cast<std::size_t>(factor) * static_cast<std::size_t>(factor))
  {
    for (auto* plane : {&x, &y, &z, &sorted})
      plane->resize(pixels * LANES);
    for (auto* row : {&row_x, &row_y, &row_z})
      row->resize(static_cast<std::size_t>(factor) * LANES);
  }

  std::size_t pixels;                      ///< per block
  std::vector<float> row_x, row_y, row_z;  ///< one row of pixels of all blocks
  std::vector<float> x, y, z, sorted;
  std::array<float, LANES> required;  ///< measured pixels that a block needs
  std::array<float, LANES> rank;      ///< of the median among the depths; -1 for an empty block
  std::array<float, LANES> median;
  std::array<float, LANES> mean_x, mean_y, mean_z;
};

/// Depths of each block in rising order, missing ones last, and the rank of its median.
BIN_PICKING_SIMD void sortDepths(const Comparators& network, Lanes& lanes)
{
  std::array<float, LANES> count{};
  for (std::size_t k = 0; k < lanes.pixels; ++k)
  {
    const float* z = &lanes.z[k * LANES];
    float* sorted = &lanes.sorted[k * LANES];
    for (std::size_t l = 0; l < LANES; ++l)
    {
      sorted[l] = z[l];
      count[l] += static_cast<float>(z[l] < NOTHING);
    }
  }
  for (const auto& [first, second] : network)
  {
    float* low = &lanes.sorted[first * LANES];
    float* high = &lanes.sorted[second * LANES];
    for (std::size_t l = 0; l < LANES; ++l)
    {
      const float a = low[l];
      const float b = high[l];
      low[l] = a < b ? a : b;
      high[l] = a < b ? b : a;
    }
  }
  // The lower median: two surfaces of the same size in a block are settled in favour of the nearer one.
  for (std::size_t l = 0; l < LANES; ++l)
    lanes.rank[l] = count[l] >= lanes.required[l] ? std::floor((count[l] - 1) / 2) : -1.0f;
}

/// Means of what lies as near to the median as one surface may; NaN for an empty block.
BIN_PICKING_SIMD void averageSurfaces(float depth_limit, float limit_per_depth, Lanes& lanes)
{
  std::array<float, LANES> limit;
  std::array<float, LANES> count{};
  lanes.median.fill(std::numeric_limits<float>::quiet_NaN());
  for (auto* mean : {&lanes.mean_x, &lanes.mean_y, &lanes.mean_z})
    mean->fill(0);
  for (std::size_t k = 0; 2 * k <= lanes.pixels; ++k)
  {
    const float* sorted = &lanes.sorted[k * LANES];
    for (std::size_t l = 0; l < LANES; ++l)
      lanes.median[l] = lanes.rank[l] == static_cast<float>(k) ? sorted[l] : lanes.median[l];
  }
  for (std::size_t l = 0; l < LANES; ++l)
    limit[l] = depth_limit + limit_per_depth * lanes.median[l];
  for (std::size_t k = 0; k < lanes.pixels; ++k)
  {
    const float* x = &lanes.x[k * LANES];
    const float* y = &lanes.y[k * LANES];
    const float* z = &lanes.z[k * LANES];
    for (std::size_t l = 0; l < LANES; ++l)
    {
      const auto weight = static_cast<float>(std::abs(z[l] - lanes.median[l]) <= limit[l]);
      lanes.mean_x[l] += weight * x[l];
      lanes.mean_y[l] += weight * y[l];
      lanes.mean_z[l] += weight * z[l];
      count[l] += weight;
    }
  }
  for (auto* mean : {&lanes.mean_x, &lanes.mean_y, &lanes.mean_z})
    for (std::size_t l = 0; l < LANES; ++l)
      (*mean)[l] /= count[l];  // 0 / 0 = NaN
}

/// What is not measured gets (0, 0, NOTHING).
BIN_PICKING_SIMD void markUnmeasured(float* x, float* y, float* z, std::size_t count)
{
  constexpr float MAX = PointView::MAX_COORDINATE;
  for (std::size_t k = 0; k < count; ++k)
  {
    const bool measured = (std::abs(x[k]) <= MAX) & (std::abs(y[k]) <= MAX) & (z[k] > 0) & (z[k] <= MAX);
    z[k] = measured ? z[k] : NOTHING;
  }
  for (std::size_t k = 0; k < count; ++k)
    x[k] = z[k] < NOTHING ? x[k] : 0.0f;
  for (std::size_t k = 0; k < count; ++k)
    y[k] = z[k] < NOTHING ? y[k] : 0.0f;
}

template <std::size_t FACTOR>
inline void split(const float* from, float* to)
{
  for (std::size_t l = 0; l < LANES; ++l)
    for (std::size_t column = 0; column < FACTOR; ++column)
      to[column * LANES + l] = from[FACTOR * l + column];
}

/// From block after block to column after column; vectors need the factor as a constant, so the common ones are.
void splitColumns(const float* from, std::size_t factor, float* to)
{
  switch (factor)
  {
    case 2:
      return split<2>(from, to);
    case 3:
      return split<3>(from, to);
    case 4:
      return split<4>(from, to);
    default:
      for (std::size_t column = 0; column < factor; ++column)
        for (std::size_t l = 0; l < LANES; ++l)
          to[column * LANES + l] = from[factor * l + column];
  }
}

class Reduction
{
public:
  Reduction(const PointView& fine, int factor, DepthGrid& reduced)
      : fine_(fine),
        factor_(factor),
        reduced_(reduced),
        network_(sortingNetwork(static_cast<std::size_t>(factor) * static_cast<std::size_t>(factor))),
        limit_per_depth_(static_cast<float>(EdgeRule().slope * fine.pitch(1.0) * factor))
  {}

  void reduceRow(int v, Lanes& lanes) const
  {
    for (int u = 0; u < reduced_.width; u += static_cast<int>(LANES))
    {
      const int count = std::min(static_cast<int>(LANES), reduced_.width - u);
      gather(u, v, count, lanes);
      sortDepths(network_, lanes);
      averageSurfaces(static_cast<float>(EdgeRule().depth), limit_per_depth_, lanes);
      const auto first = static_cast<std::size_t>(reduced_.index(u, v));
      std::copy_n(lanes.mean_x.begin(), count, &reduced_.x[first]);
      std::copy_n(lanes.mean_y.begin(), count, &reduced_.y[first]);
      std::copy_n(lanes.mean_z.begin(), count, &reduced_.z[first]);
    }
  }

private:
  /// The pixels of `count` blocks from block (u, v) on. Lanes without a block, and pixels beyond the picture, are
  /// empty.
  void gather(int u, int v, int count, Lanes& lanes) const
  {
    const int rows = std::min(factor_, fine_.height - v * factor_);
    for (std::size_t l = 0; l < LANES; ++l)
    {
      const int columns = std::min(factor_, fine_.width - (u + static_cast<int>(l)) * factor_);
      lanes.required[l] = std::max(1.0f, std::ceil(static_cast<float>(rows * columns) / MIN_BLOCK_SHARE));
    }
    const int begin = u * factor_;
    const int size = std::min(count * factor_, fine_.width - begin);
    for (int row = 0; row < factor_; ++row)
    {
      std::fill(lanes.row_z.begin(), lanes.row_z.end(), NOTHING);
      if (row < rows)
        loadRow(static_cast<std::size_t>(fine_.index(begin, v * factor_ + row)), static_cast<std::size_t>(size), lanes);
      const auto factor = static_cast<std::size_t>(factor_);
      const std::size_t to = static_cast<std::size_t>(row) * factor * LANES;
      splitColumns(lanes.row_x.data(), factor, &lanes.x[to]);
      splitColumns(lanes.row_y.data(), factor, &lanes.y[to]);
      splitColumns(lanes.row_z.data(), factor, &lanes.z[to]);
    }
  }

  void loadRow(std::size_t first, std::size_t size, Lanes& lanes) const
  {
    const std::size_t step = fine_.step;
    const float* x = fine_.x + first * step;
    const float* y = fine_.y + first * step;
    const float* z = fine_.z + first * step;
    for (std::size_t k = 0; k < size; ++k)
    {
      lanes.row_x[k] = x[k * step];
      lanes.row_y[k] = y[k * step];
      lanes.row_z[k] = z[k * step];
    }
    markUnmeasured(lanes.row_x.data(), lanes.row_y.data(), lanes.row_z.data(), size);
  }

  const PointView& fine_;
  int factor_;
  DepthGrid& reduced_;
  Comparators network_;
  float limit_per_depth_;
};
}  // namespace

DepthGrid reduceGrid(const PointView& points, int factor, const Executor& executor)
{
  if (factor < 1)
    throw ParameterError("The reduction factor is " + std::to_string(factor) + ", but it must be at least 1.");
  if (factor == 1)
    return copyMeasured(points);
  const PinholeCamera& c = points.camera;
  const double middle = (factor - 1) / 2.0;  // the centre of the first block, in pixels of the fine grid
  DepthGrid reduced = makeGrid((points.width + factor - 1) / factor, (points.height + factor - 1) / factor,
                               {c.fx / factor, c.fy / factor, (c.cx - middle) / factor, (c.cy - middle) / factor});
  const Reduction reduction(points, factor, reduced);
  constexpr int BAND = 8;  // rows per task
  executor.forEach(static_cast<std::size_t>((reduced.height + BAND - 1) / BAND), [&](std::size_t band) {
    Lanes lanes(factor);
    const int begin = static_cast<int>(band) * BAND;
    for (int v = begin; v < std::min(reduced.height, begin + BAND); ++v)
      reduction.reduceRow(v, lanes);
  });
  return reduced;
}

int reductionFactor(const PointView& points, double leaf, const PreprocessingParameters& parameters)
{
  const double depth = medianDepth(points);
  if (!(depth > 0))
    return 1;
  const double factor = std::round(leaf / parameters.pixels_per_leaf / points.pitch(depth));
  const double largest = std::max(1, std::min(points.width, points.height));
  return static_cast<int>(std::clamp(factor, 1.0, largest));
}
}  // namespace bin_picking
