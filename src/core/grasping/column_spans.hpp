// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "surface_blocks.hpp"

namespace bin_picking
{
/// From where to where a part's surface reaches along a direction, column by column: what moves along it elsewhere
/// meets nothing, as most of a part's surroundings do. Part frame.
class ColumnSpans
{
public:
  /// Coordinates along the direction, metres; where there is no surface, the end lies before the beginning.
  struct Span
  {
    float begin = std::numeric_limits<float>::infinity();
    float end = -std::numeric_limits<float>::infinity();
  };

  /// \param direction of unit length \param most of what may be asked of within(), metres
  ColumnSpans(const SurfaceBlocks& surface, const Eigen::Vector3f& direction, float most);

  /// The same where all that is so close to a column counts as in it, metres.
  ColumnSpans within(float distance) const;

  /// Of the point's column.
  Span at(const Eigen::Vector3f& point) const
  {
    const Eigen::Vector2f q = (across_ * point - low_) / CELL;
    const bool inside =
        q.x() >= 0 && q.y() >= 0 && q.x() < static_cast<float>(columns_) && q.y() < static_cast<float>(rows_);
    return inside ? Span{-back_[index(q)], ahead_[index(q)]} : Span{};
  }

private:
  static constexpr float CELL = 0.003f;  // metres

  static std::size_t cellsFor(float distance)
  {
    constexpr float ROUNDING = 1e-5f;
    return static_cast<std::size_t>(std::ceil((distance + ROUNDING) / CELL));
  }
  std::size_t index(const Eigen::Vector2f& q) const
  {
    return static_cast<std::size_t>(q.y()) * stride_ + static_cast<std::size_t>(q.x());
  }

  Eigen::Matrix<float, 2, 3> across_;  ///< to coordinates in the plane of the columns
  Eigen::Vector2f low_ = Eigen::Vector2f::Zero();
  float patch_ = 0;  ///< largest radius of what was entered by its middle, metres
  std::size_t stride_ = 0;
  std::size_t columns_ = 0;  ///< up to here each knows what is around it
  std::size_t rows_ = 0;
  std::vector<float> ahead_;  ///< the farthest along the direction
  std::vector<float> back_;   ///< and against it
};
}  // namespace bin_picking
