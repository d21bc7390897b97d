// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"

namespace bin_picking
{
namespace
{
/// A block with fewer measured pixels than one in this many stays empty, so that stray pixels do not spread.
constexpr std::size_t MIN_BLOCK_SHARE = 4;

struct Block
{
  int u_begin, u_end, v_begin, v_end;
  std::size_t pixels() const
  {
    return static_cast<std::size_t>(u_end - u_begin) * static_cast<std::size_t>(v_end - v_begin);
  }
};

class BlockMean
{
public:
  BlockMean(const DepthGrid& grid, int factor)
      : grid_(grid), limit_per_depth_(static_cast<float>(EdgeRule().slope * grid.pitch(1.0) * factor))
  {}

  /// Mean of the block's surface; false if there is none.
  bool operator()(const Block& block, Eigen::Vector3f& mean)
  {
    depths_.clear();
    for (int v = block.v_begin; v < block.v_end; ++v)
      for (int u = block.u_begin; u < block.u_end; ++u)
        if (const float z = grid_.z[static_cast<std::size_t>(grid_.index(u, v))]; !std::isnan(z))
          depths_.push_back(z);
    if (depths_.size() * MIN_BLOCK_SHARE < block.pixels() || depths_.empty())
      return false;
    // The lower median: two surfaces of the same size in a block are settled in favour of the nearer one.
    const auto middle = depths_.begin() + static_cast<std::ptrdiff_t>((depths_.size() - 1) / 2);
    std::nth_element(depths_.begin(), middle, depths_.end());
    mean = meanNear(block, *middle);
    return true;
  }

private:
  Eigen::Vector3f meanNear(const Block& block, float depth) const
  {
    const float limit = static_cast<float>(EdgeRule().depth) + limit_per_depth_ * depth;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    float count = 0;
    for (int v = block.v_begin; v < block.v_end; ++v)
    {
      for (int u = block.u_begin; u < block.u_end; ++u)
      {
        const int i = grid_.index(u, v);
        if (!(std::abs(grid_.z[static_cast<std::size_t>(i)] - depth) <= limit))
          continue;
        sum += grid_.point(i);
        count += 1;
      }
    }
    return sum / count;
  }

  const DepthGrid& grid_;
  float limit_per_depth_;
  std::vector<float> depths_;
};
}  // namespace

void PreprocessingParameters::visit(ParameterVisitor& v)
{
  v.field({"pixels_per_leaf", "",
           "working resolution: pixels are merged until about this many fit in a leaf; more is finer "
           "and slower",
           0.5, 50},
          pixels_per_leaf);
  v.field(
      {"outlier_window", "px", "half size of the window in which a point needs neighbours; 0 keeps every point", 0, 20},
      outlier_window);
  v.field({"outlier_min_share", "", "a point with a smaller share of near neighbours in the window is dropped", 0, 1},
          outlier_min_share);
  v.field({"outlier_distance", "m", "depth difference up to which a neighbour counts as near; grows with the distance",
           0.0001, 1},
          outlier_distance);
  v.field({"max_normal_tilt", "rad", "surfaces turned further away from the camera are not sampled", 0.1, 1.5708},
          max_normal_tilt);
  v.field({"split_by_normal", "", "a leaf with several surface directions keeps one sample for each (up to three)"},
          split_by_normal);
}

DepthGrid reduceGrid(const DepthGrid& grid, int factor)
{
  if (factor < 1)
    throw ParameterError("The reduction factor is " + std::to_string(factor) + ", but it must be at least 1.");
  if (factor == 1)
    return grid;
  const PinholeCamera& c = grid.camera;
  const double middle = (factor - 1) / 2.0;  // the centre of the first block, in pixels of the fine grid
  DepthGrid reduced = makeGrid((grid.width + factor - 1) / factor, (grid.height + factor - 1) / factor,
                               {c.fx / factor, c.fy / factor, (c.cx - middle) / factor, (c.cy - middle) / factor});
  BlockMean block_mean(grid, factor);
  Eigen::Vector3f mean;
  for (int v = 0; v < reduced.height; ++v)
  {
    for (int u = 0; u < reduced.width; ++u)
    {
      const Block block{u * factor, std::min(grid.width, (u + 1) * factor), v * factor,
                        std::min(grid.height, (v + 1) * factor)};
      if (!block_mean(block, mean))
        continue;
      const auto i = static_cast<std::size_t>(reduced.index(u, v));
      reduced.x[i] = mean.x();
      reduced.y[i] = mean.y();
      reduced.z[i] = mean.z();
    }
  }
  return reduced;
}

int reductionFactor(const DepthGrid& grid, double leaf, const PreprocessingParameters& parameters)
{
  const double depth = medianDepth(grid);
  if (!(depth > 0))
    return 1;
  const double factor = std::round(leaf / parameters.pixels_per_leaf / grid.pitch(depth));
  return static_cast<int>(std::clamp(factor, 1.0, static_cast<double>(std::max(1, std::min(grid.width, grid.height)))));
}
}  // namespace bin_picking
