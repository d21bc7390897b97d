// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/distance_field.hpp"

#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/kd_tree.hpp"

namespace bin_picking
{
DistanceField::DistanceField(const OrientedPoints& surface, double cell, double band, const Executor& executor)
    : band_(static_cast<float>(band)), inverse_cell_(static_cast<float>(1 / cell))
{
  if (surface.empty())
    return;
  Eigen::Vector3f low = surface.points[0];
  Eigen::Vector3f high = low;
  for (const Eigen::Vector3f& p : surface.points)
  {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  low_ = low.array() - band_;
  const Eigen::Array3i nodes = ((high.array() + band_ - low_.array()) * inverse_cell_).ceil().cast<int>() + 2;
  limit_ = (nodes - 1).cast<float>();
  columns_ = static_cast<std::size_t>(nodes.x());
  rows_ = static_cast<std::size_t>(nodes.y());
  values_.assign(columns_ * rows_ * static_cast<std::size_t>(nodes.z()), band_);
  const KdTree tree(surface.points);
  executor.forEach(static_cast<std::size_t>(nodes.z()), [&](std::size_t z) {
    for (std::size_t y = 0; y < rows_; ++y)
    {
      float side = 1;  // of the node before: farther than the band from the surface, the side cannot change
      for (std::size_t x = 0; x < columns_; ++x)
      {
        float& value = values_[(z * rows_ + y) * columns_ + x];
        const Eigen::Vector3f p =
            low_ + static_cast<float>(cell) *
                       Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
        const auto nearest = tree.nearest(p, band_);
        if (nearest.index < 0)
        {
          value = side * band_;
          continue;
        }
        const auto k = static_cast<std::size_t>(nearest.index);
        // Near the surface the tangent plane is exact, where the distance to the sample beside the foot is too long.
        const float height = surface.normals[k].dot(p - surface.points[k]);
        const float distance = std::sqrt(nearest.squared_distance);
        const bool above = std::abs(height) > 0.7f * distance || distance < static_cast<float>(cell);
        value = above ? height : std::copysign(distance, height);
        side = std::copysign(1.0f, value);
      }
    }
  });
}
}  // namespace bin_picking
