// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace bin_picking
{
/// Nearest-neighbour search in fixed points. Immutable after construction; safe to query from many threads.
class KdTree
{
public:
  /// Copies the points. None may be NaN.
  explicit KdTree(std::vector<Eigen::Vector3f> points);
  ~KdTree();
  KdTree(KdTree&&) noexcept;
  KdTree& operator=(KdTree&&) noexcept;

  /// Indices of the points within `radius` of `query`, ascending.
  void radiusSearch(const Eigen::Vector3f& query, float radius, std::vector<int>& indices) const;

  struct Neighbour
  {
    int index = -1;  ///< -1: none
    float squared_distance = 0;
  };
  /// The nearest point if it is closer than `max_distance`.
  Neighbour nearest(const Eigen::Vector3f& query, float max_distance) const;

  const std::vector<Eigen::Vector3f>& points() const;

private:
  struct Index;
  std::unique_ptr<Index> index_;
};
}  // namespace bin_picking
