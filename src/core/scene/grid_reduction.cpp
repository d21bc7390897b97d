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

// Most blocks see one surface, and their mean is all that is asked for: sums over the rows of pixels, and then over the
// columns of each block. Blocks that see more than one are settled LANES at a time, side by side: what is the k-th
// pixel of each lies together, so that the median (a sorting network) and the mean are plain loops over the lanes.

namespace bin_picking
{
namespace
{
/// A block with fewer measured pixels than one in this many stays empty, so that stray pixels do not spread.
constexpr int MIN_BLOCK_SHARE = 4;
constexpr std::size_t LANES = 32;
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
    std::fill(near.begin(), near.end(), NOTHING);
  }

  std::vector<float> x, y, z;  ///< sums over the measured pixels
  std::vector<float> count;    ///< of measured pixels
  std::vector<float> near;     ///< smallest depth
  std::vector<float> far;      ///< largest depth
};

/// The same for whole blocks.
using Blocks = Columns;

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
    const bool measured = (std::abs(px) <= MAX) & (std::abs(py) <= MAX) & (pz > 0) & (pz <= MAX);
    const float nearest = measured ? pz : NOTHING;
    const float furthest = measured ? pz : 0.0f;
    x[k] += measured ? px : 0.0f;
    y[k] += measured ? py : 0.0f;
    z[k] += furthest;
    pixels[k] += measured ? 1.0f : 0.0f;
    near[k] = nearest < near[k] ? nearest : near[k];
    far[k] = furthest > far[k] ? furthest : far[k];
  }
}

/// Vectors need the step as a constant: that of a grid's planes is 1, that of a PCL cloud's points is 4.
BIN_PICKING_SIMD void addPixels(const float* x, const float* y, const float* z, std::size_t step, std::size_t count,
                                Columns& c)
{
  const auto add = [&](std::size_t constant) __attribute__((always_inline))
  {
    addRow(x, y, z, constant, count, c.x.data(), c.y.data(), c.z.data(), c.count.data(), c.near.data(), c.far.data());
  };
  step == 1 ? add(1) : step == 4 ? add(4) : add(step);
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

/// Depths that lie on one surface: at most so far from its median.
struct DepthLimit
{
  float depth;
  float per_depth;

  float at(float median) const { return depth + per_depth * median; }
};

/// Means of blocks that have the pixels that they need, NaN for others. \param mixed set where not all pixels lie
/// within the limit of whatever their median is: the mean is not that of one surface
BIN_PICKING_SIMD void averageBlocks(const Blocks& blocks, const std::vector<float>& required, const DepthLimit& given,
                                    float* __restrict x, float* __restrict y, float* __restrict z,
                                    std::uint8_t* __restrict mixed)
{
  const DepthLimit limit = given;
  const std::size_t size = required.size();
  for (std::size_t b = 0; b < size; ++b)
  {
    const float count = blocks.count[b];
    const float scale = count >= required[b] ? 1.0f : std::numeric_limits<float>::quiet_NaN();
    x[b] = scale * blocks.x[b] / count;
    y[b] = scale * blocks.y[b] / count;
    z[b] = scale * blocks.z[b] / count;
    mixed[b] = (count >= required[b]) & (blocks.far[b] - blocks.near[b] > limit.at(blocks.near[b]));
  }
}

/// Working memory of LANES blocks of factor x factor pixels; what belongs to one pixel position lies together.
struct Lanes
{
  explicit Lanes(int factor) : pixels(static_cast<std::size_t>(factor) * static_cast<std::size_t>(factor))
  {
    for (auto* plane : {&x, &y, &z, &sorted})
      plane->resize(pixels * LANES);
  }

  std::size_t pixels;  ///< per block
  std::vector<float> x, y, z, sorted;
  std::array<float, LANES> median;
  std::array<float, LANES> mean_x, mean_y, mean_z;
};

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

/// Median depth of each block; missing pixels are sorted last.
BIN_PICKING_SIMD void findMedians(const Comparators& network, Lanes& lanes)
{
  std::array<float, LANES> count{};
  std::array<float, LANES> rank;
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
    exchange(&lanes.sorted[first * LANES], &lanes.sorted[second * LANES]);
  // The lower median: two surfaces of the same size in a block are settled in favour of the nearer one.
  for (std::size_t l = 0; l < LANES; ++l)
    rank[l] = std::floor((count[l] - 1) / 2);
  for (std::size_t k = 0; 2 * k <= lanes.pixels; ++k)
  {
    const float* sorted = &lanes.sorted[k * LANES];
    for (std::size_t l = 0; l < LANES; ++l)
      lanes.median[l] = rank[l] == static_cast<float>(k) ? sorted[l] : lanes.median[l];
  }
}

/// Means of what lies as near to the median as one surface may.
BIN_PICKING_SIMD void averageSurfaces(const DepthLimit& given, Lanes& lanes)
{
  const DepthLimit limit = given;
  const std::array<float, LANES> median = lanes.median;
  std::array<float, LANES> sum_x{};
  std::array<float, LANES> sum_y{};
  std::array<float, LANES> sum_z{};
  std::array<float, LANES> count{};
  for (std::size_t k = 0; k < lanes.pixels; ++k)
  {
    const float* x = &lanes.x[k * LANES];
    const float* y = &lanes.y[k * LANES];
    const float* z = &lanes.z[k * LANES];
    for (std::size_t l = 0; l < LANES; ++l)
    {
      const auto weight = static_cast<float>(std::abs(z[l] - median[l]) <= limit.at(median[l]));
      sum_x[l] += weight * x[l];
      sum_y[l] += weight * y[l];
      sum_z[l] += weight * z[l];
      count[l] += weight;
    }
  }
  for (std::size_t l = 0; l < LANES; ++l)
  {
    lanes.mean_x[l] = sum_x[l] / count[l];
    lanes.mean_y[l] = sum_y[l] / count[l];
    lanes.mean_z[l] = sum_z[l] / count[l];
  }
}

class Reduction
{
public:
  /// Working memory of one task.
  struct Memory
  {
    explicit Memory(const Reduction& reduction)
        : columns(static_cast<std::size_t>(reduction.reduced_.width * reduction.factor_)),
          blocks(static_cast<std::size_t>(reduction.reduced_.width)),
          required(blocks.x.size()),
          mixed(blocks.x.size()),
          lanes(reduction.factor_)
    {}

    Columns columns;
    Blocks blocks;
    std::vector<float> required;      ///< measured pixels that a block needs
    std::vector<std::uint8_t> mixed;  ///< blocks that see more than one surface
    std::vector<int> to_settle;       ///< the same, as columns of the reduced grid
    Lanes lanes;
  };

  Reduction(const PointView& fine, int factor, DepthGrid& reduced)
      : fine_(fine),
        factor_(factor),
        reduced_(reduced),
        network_(sortingNetwork(static_cast<std::size_t>(factor) * static_cast<std::size_t>(factor))),
        limit_{static_cast<float>(EdgeRule().depth), static_cast<float>(EdgeRule().slope * fine.pitch(1.0) * factor)}
  {}

  void reduceRow(int v, Memory& memory) const
  {
    memory.columns.clear();
    const int end = std::min(fine_.height, (v + 1) * factor_);
    for (int row = v * factor_; row < end; ++row)
      add(row, memory.columns);
    joinColumns(memory.columns, static_cast<std::size_t>(factor_), memory.blocks);
    std::fill(memory.required.begin(), memory.required.end(), required(0, v));
    memory.required.back() = required(reduced_.width - 1, v);
    const auto i = static_cast<std::size_t>(reduced_.index(0, v));
    averageBlocks(memory.blocks, memory.required, limit_, &reduced_.x[i], &reduced_.y[i], &reduced_.z[i],
                  memory.mixed.data());
    memory.to_settle.clear();
    for (int u = 0; u < reduced_.width; ++u)
      if (memory.mixed[static_cast<std::size_t>(u)] != 0)
        memory.to_settle.push_back(u);
    for (std::size_t first = 0; first < memory.to_settle.size(); first += LANES)
      settle(v, &memory.to_settle[first], std::min(LANES, memory.to_settle.size() - first), memory.lanes);
  }

private:
  void add(int row, Columns& columns) const
  {
    const std::size_t first = static_cast<std::size_t>(fine_.index(0, row)) * fine_.step;
    const auto width = static_cast<std::size_t>(fine_.width);
    addPixels(fine_.x + first, fine_.y + first, fine_.z + first, fine_.step, width, columns);
  }

  /// Measured pixels that a block needs.
  float required(int u, int v) const
  {
    const int rows = std::min(factor_, fine_.height - v * factor_);
    const int columns = std::min(factor_, fine_.width - u * factor_);
    return std::max(1.0f, std::ceil(static_cast<float>(rows * columns) / MIN_BLOCK_SHARE));
  }

  /// Means of blocks that see more than one surface.
  void settle(int v, const int* mixed, std::size_t count, Lanes& lanes) const
  {
    for (std::size_t l = 0; l < count; ++l)
      gather(mixed[l], v, l, lanes);
    findMedians(network_, lanes);
    averageSurfaces(limit_, lanes);
    for (std::size_t l = 0; l < count; ++l)
    {
      const auto i = static_cast<std::size_t>(reduced_.index(mixed[l], v));
      reduced_.x[i] = lanes.mean_x[l];
      reduced_.y[i] = lanes.mean_y[l];
      reduced_.z[i] = lanes.mean_z[l];
    }
  }

  /// What is not measured, or lies beyond the picture, is (0, 0, NOTHING).
  void gather(int u, int v, std::size_t lane, Lanes& lanes) const
  {
    std::size_t k = lane;
    for (int row = v * factor_; row < (v + 1) * factor_; ++row)
      for (int column = u * factor_; column < (u + 1) * factor_; ++column, k += LANES)
      {
        const int i = fine_.index(column, row);
        const bool measured = column < fine_.width && row < fine_.height && fine_.measured(i);
        const Eigen::Vector3f point = measured ? fine_.point(i) : Eigen::Vector3f(0, 0, NOTHING);
        lanes.x[k] = point.x();
        lanes.y[k] = point.y();
        lanes.z[k] = point.z();
      }
  }

  const PointView& fine_;
  int factor_;
  DepthGrid& reduced_;
  Comparators network_;
  DepthLimit limit_;
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
    Reduction::Memory memory(reduction);
    const int begin = static_cast<int>(band) * BAND;
    for (int v = begin; v < std::min(reduced.height, begin + BAND); ++v)
      reduction.reduceRow(v, memory);
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
