// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/distance_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bin_picking
{
namespace
{
constexpr float LARGEST = std::numeric_limits<std::int16_t>::max();

/// For each node of a grid the nearest of many points, handed on from node to node (Danielsson 1980): each node asks
/// the neighbours that a sweep has already passed for theirs. Two opposite sweeps reach all nodes.
class NearestPoints
{
public:
  NearestPoints(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& low, float cell,
                const Eigen::Array3i& nodes)
      : points_(points), low_(low), cell_(cell), nodes_(nodes)
  {
    nearest_.assign(
        static_cast<std::size_t>(nodes.x()) * static_cast<std::size_t>(nodes.y()) * static_cast<std::size_t>(nodes.z()),
        -1);
    squared_.assign(nearest_.size(), std::numeric_limits<float>::infinity());
    seed();
    sweep(1);
    sweep(-1);
  }

  /// Index of the nearest point.
  std::size_t of(std::size_t node) const { return static_cast<std::size_t>(nearest_[node]); }
  float squaredDistance(std::size_t node) const { return squared_[node]; }

private:
  std::size_t indexOf(int x, int y, int z) const
  {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(nodes_.y()) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(nodes_.x()) +
           static_cast<std::size_t>(x);
  }

  Eigen::Vector3f position(int x, int y, int z) const
  {
    return low_ + cell_ * Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  }

  void offer(std::size_t node, const Eigen::Vector3f& position, std::int32_t point)
  {
    const float squared = (points_[static_cast<std::size_t>(point)] - position).squaredNorm();
    if (squared < squared_[node])
    {
      squared_[node] = squared;
      nearest_[node] = point;
    }
  }

  /// The corners of the cell around each point.
  void seed()
  {
    for (std::size_t i = 0; i < points_.size(); ++i)
    {
      const Eigen::Array3i corner = ((points_[i] - low_).array() / cell_).cast<int>();
      for (int k = 0; k < 8; ++k)
      {
        const Eigen::Array3i node = corner + Eigen::Array3i(k & 1, (k >> 1) & 1, k >> 2);
        offer(indexOf(node.x(), node.y(), node.z()), position(node.x(), node.y(), node.z()),
              static_cast<std::int32_t>(i));
      }
    }
  }

  void sweep(int direction)
  {
    const int begin_z = direction > 0 ? 0 : nodes_.z() - 1;
    const int begin_y = direction > 0 ? 0 : nodes_.y() - 1;
    const int begin_x = direction > 0 ? 0 : nodes_.x() - 1;
    for (int z = begin_z; z >= 0 && z < nodes_.z(); z += direction)
      for (int y = begin_y; y >= 0 && y < nodes_.y(); y += direction)
        for (int x = begin_x; x >= 0 && x < nodes_.x(); x += direction)
          askNeighbours(x, y, z, direction);
  }

  void askNeighbours(int x, int y, int z, int direction)
  {
    const std::size_t node = indexOf(x, y, z);
    const Eigen::Vector3f own = position(x, y, z);
    std::int32_t asked = nearest_[node];
    // The 13 of the 26 neighbours that come before in the order of the sweep.
    for (int k = 0; k < 13; ++k)
    {
      const int nx = x + direction * (k % 3 - 1);
      const int ny = y + direction * (k / 3 % 3 - 1);
      const int nz = z + direction * (k / 9 - 1);
      if (nx < 0 || ny < 0 || nz < 0 || nx >= nodes_.x() || ny >= nodes_.y() || nz >= nodes_.z())
        continue;
      const std::int32_t point = nearest_[indexOf(nx, ny, nz)];
      if (point < 0 || point == asked)
        continue;
      asked = point;
      offer(node, own, point);
    }
  }

  const std::vector<Eigen::Vector3f>& points_;
  Eigen::Vector3f low_;
  float cell_;
  Eigen::Array3i nodes_;
  std::vector<std::int32_t> nearest_;
  std::vector<float> squared_;
};
}  // namespace

void DistanceField::fillDerived()
{
  step_ = band_ / LARGEST;
  const std::size_t layer = std::max<std::size_t>(1, columns_ * rows_);
  const std::size_t layers = values_.size() / layer;
  limit_ = Eigen::Array3f(static_cast<float>(columns_), static_cast<float>(rows_), static_cast<float>(layers)) - 1;
}

DistanceField::DistanceField(const OrientedPoints& surface, double cell, double band)
    : band_(static_cast<float>(band)), inverse_cell_(static_cast<float>(1 / cell))
{
  if (surface.empty())
    return;
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : surface.points)
    box.extend(p);
  low_ = box.min().array() - band_;
  const Eigen::Array3i nodes = ((box.max().array() + band_ - low_.array()) * inverse_cell_).ceil().cast<int>() + 2;
  columns_ = static_cast<std::size_t>(nodes.x());
  rows_ = static_cast<std::size_t>(nodes.y());
  values_.assign(columns_ * rows_ * static_cast<std::size_t>(nodes.z()), 0);
  fillDerived();
  const NearestPoints nearest(surface.points, low_, static_cast<float>(cell), nodes);
  std::size_t node = 0;
  for (int z = 0; z < nodes.z(); ++z)
    for (int y = 0; y < nodes.y(); ++y)
      for (int x = 0; x < nodes.x(); ++x, ++node)
      {
        const Eigen::Vector3f p =
            low_ + static_cast<float>(cell) *
                       Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
        const std::size_t k = nearest.of(node);
        // Near the surface the tangent plane is exact, where the distance to the sample beside the foot is too long.
        const float height = surface.normals[k].dot(p - surface.points[k]);
        const float distance = std::sqrt(nearest.squaredDistance(node));
        const bool above = std::abs(height) > 0.7f * distance || distance < static_cast<float>(cell);
        const float value = above ? height : std::copysign(distance, height);
        values_[node] = static_cast<std::int16_t>(std::lround(std::clamp(value / step_, -LARGEST, LARGEST)));
      }
}
}  // namespace bin_picking
