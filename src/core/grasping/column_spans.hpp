// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <limits>
#include <vector>

#include "surface_blocks.hpp"

namespace bin_picking
{
/// How far a part's surface reaches along a direction, column by column: what moves along it from above that meets
/// nothing, which most of a part's surroundings do. Part frame.
class ColumnTops
{
public:
  /// \param direction of unit length \param around what is this close to a column counts as in it, metres
  ColumnTops(const SurfaceBlocks& surface, const Eigen::Vector3f& direction, float around);

  /// The largest coordinate along the direction of any surface near the point's column; -infinity where there is none.
  float at(const Eigen::Vector3f& point) const
  {
    const Eigen::Vector2f q = (across_ * point - low_) / CELL;
    const bool inside =
        q.x() >= 0 && q.y() >= 0 && q.x() < static_cast<float>(columns_) && q.y() < static_cast<float>(rows_);
    return inside ? tops_[index(q)] : -std::numeric_limits<float>::infinity();
  }

private:
  static constexpr float CELL = 0.002f;  // metres

  std::size_t index(const Eigen::Vector2f& q) const
  {
    return static_cast<std::size_t>(q.y()) * columns_ + static_cast<std::size_t>(q.x());
  }

  Eigen::Matrix<float, 2, 3> across_;  ///< to coordinates in the plane of the columns
  Eigen::Vector2f low_ = Eigen::Vector2f::Zero();
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  std::vector<float> tops_;
};
}  // namespace bin_picking
