// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <vector>

namespace bin_picking
{
/// Scene points in square columns of the x-y plane, so that the neighbours of a reference point are found without a
/// tree: they are few thousand in a few cells.
class TileIndex
{
public:
  TileIndex(const std::vector<Eigen::Vector3f>& points, float tile);

  /// Point indices tile by tile: neighbours in the plane are few runs of it.
  const std::vector<int>& order() const { return order_; }

  /// Calls visit(begin, end) for the runs of order() whose tiles may hold neighbours within `radius` of `center`, in a
  /// fixed order.
  template <typename Visit>
  void forEachRun(const Eigen::Vector3f& center, float radius, const Visit& visit) const
  {
    const int x_end = column(center.x() + radius, low_.x(), columns_);
    const int y_end = column(center.y() + radius, low_.y(), rows_);
    for (int y = column(center.y() - radius, low_.y(), rows_); y <= y_end; ++y)
    {
      const auto row = static_cast<std::size_t>(y * columns_);
      const auto begin = starts_[row + static_cast<std::size_t>(column(center.x() - radius, low_.x(), columns_))];
      const auto end = starts_[row + static_cast<std::size_t>(x_end) + 1];
      if (begin < end)
        visit(begin, end);
    }
  }

private:
  int column(float value, float low, int count) const;

  float tile_;
  Eigen::Vector2f low_ = Eigen::Vector2f::Zero();
  int columns_ = 1;
  int rows_ = 1;
  std::vector<std::size_t> starts_;  ///< per tile, row by row; the last is the number of points
  std::vector<int> order_;
};
}  // namespace bin_picking
