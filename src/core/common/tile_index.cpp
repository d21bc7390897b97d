// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "tile_index.hpp"

#include <algorithm>
#include <cmath>

namespace bin_picking
{
TileIndex::TileIndex(const std::vector<Eigen::Vector3f>& points, float tile) : tile_(tile)
{
  if (points.empty())
  {
    starts_.assign(2, 0);
    return;
  }
  low_ = points.front().head<2>();
  Eigen::Vector2f high = low_;
  for (const auto& p : points)
  {
    low_ = low_.cwiseMin(p.head<2>());
    high = high.cwiseMax(p.head<2>());
  }
  constexpr float MAX_TILES_PER_SIDE = 1024;  // a stray point far away must not cost memory
  tile_ = std::max(tile_, (high - low_).maxCoeff() / MAX_TILES_PER_SIDE);
  columns_ = static_cast<int>((high.x() - low_.x()) / tile_) + 1;
  rows_ = static_cast<int>((high.y() - low_.y()) / tile_) + 1;

  starts_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  std::vector<std::size_t> tile_of(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const auto row = static_cast<std::size_t>(column(points[i].y(), low_.y(), rows_));
    tile_of[i] =
        row * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column(points[i].x(), low_.x(), columns_));
    ++starts_[tile_of[i] + 1];
  }
  for (std::size_t t = 1; t < starts_.size(); ++t)
    starts_[t] += starts_[t - 1];
  order_.resize(points.size());
  std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i)
    order_[next[tile_of[i]]++] = static_cast<int>(i);
}

int TileIndex::column(float value, float low, int count) const
{
  return std::min(std::max(static_cast<int>(std::floor((value - low) / tile_)), 0), count - 1);
}
}  // namespace bin_picking
