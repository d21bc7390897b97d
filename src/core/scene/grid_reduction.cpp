// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"
#include "block_medians.hpp"
#include "block_sums.hpp"

// Most blocks see one surface, and their mean is all that is asked for: sums over the rows of pixels, and then over the
// columns of each block. Only those that see more than one are settled by their median.

namespace bin_picking
{
namespace
{
/// A block with fewer measured pixels than one in this many stays empty, so that stray pixels do not spread.
constexpr int MIN_BLOCK_SHARE = 4;

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
          medians(static_cast<std::size_t>(reduction.factor_ * reduction.factor_))
    {}

    Columns columns;
    Blocks blocks;
    std::vector<float> required;      ///< measured pixels that a block needs
    std::vector<std::uint8_t> mixed;  ///< blocks that see more than one surface
    std::vector<int> to_settle;       ///< the same, as columns of the reduced grid
    BlockMedians medians;
  };

  Reduction(const PointView& fine, int factor, DepthGrid& reduced)
      : fine_(fine),
        factor_(factor),
        reduced_(reduced),
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
    constexpr std::size_t LANES = BlockMedians::LANES;
    for (std::size_t first = 0; first < memory.to_settle.size(); first += LANES)
      settle(v, &memory.to_settle[first], std::min(LANES, memory.to_settle.size() - first), memory.medians);
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
  void settle(int v, const int* mixed, std::size_t count, BlockMedians& medians) const
  {
    for (std::size_t lane = 0; lane < count; ++lane)
      gather(mixed[lane], v, lane, medians);
    medians.average(limit_);
    for (std::size_t lane = 0; lane < count; ++lane)
    {
      const auto i = static_cast<std::size_t>(reduced_.index(mixed[lane], v));
      reduced_.x[i] = medians.x(lane);
      reduced_.y[i] = medians.y(lane);
      reduced_.z[i] = medians.z(lane);
    }
  }

  void gather(int u, int v, std::size_t lane, BlockMedians& medians) const
  {
    std::size_t k = 0;
    for (int row = v * factor_; row < (v + 1) * factor_; ++row)
      for (int column = u * factor_; column < (u + 1) * factor_; ++column, ++k)
      {
        const int i = fine_.index(column, row);
        const bool measured = column < fine_.width && row < fine_.height && fine_.measured(i);
        const Eigen::Vector3f point = measured ? fine_.point(i) : Eigen::Vector3f(0, 0, NOT_MEASURED);
        medians.set(lane, k, point.x(), point.y(), point.z());
      }
  }

  const PointView& fine_;
  int factor_;
  DepthGrid& reduced_;
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
