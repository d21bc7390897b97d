// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "surface_blocks.hpp"
#include "sweep_lanes.hpp"

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
    const Eigen::Vector2f q = ((across_ * point - low_) / CELL).cwiseMax(0.0f).cwiseMin(last_);
    return {-back_[index(q)], ahead_[index(q)]};
  }

  /// From points in another frame to their columns and how far along the direction they are.
  struct View
  {
    Eigen::Matrix3f turn;
    Eigen::Vector3f origin;
  };
  View seenFrom(const Eigen::Isometry3f& T_object_other) const;

  /// Which of BLOCK points may come within the distance of a column's span on a way of that length along the direction:
  /// a bit for each. The points are those of pixels side by side. \param ray of the first pixel, z = 1 \param step of
  /// the rays' x from pixel to pixel \param depth of each, metres
  unsigned meetOnWay(const View& from_camera, const Eigen::Vector3f& ray, float step, const float* depth,
                     float distance, float length) const;
  /// The same of any points.
  unsigned meetOnWay(const View& view, const float* x, const float* y, const float* z, float distance,
                     float length) const;

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

  Eigen::Vector3f direction_;
  Eigen::Matrix<float, 2, 3> across_;  ///< to coordinates in the plane of the columns
  Eigen::Vector2f low_ = Eigen::Vector2f::Zero();
  float patch_ = 0;  ///< largest radius of what was entered by its middle, metres
  std::size_t stride_ = 1;
  Eigen::Vector2f last_ = Eigen::Vector2f::Zero();  ///< column and row; as the first, they are empty
  std::vector<float> ahead_;                        ///< the farthest along the direction
  std::vector<float> back_;                         ///< and against it
};
}  // namespace bin_picking
