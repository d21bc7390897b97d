// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstddef>
#include <vector>

#include "body_sweep.hpp"

namespace bin_picking
{
/// The points of a part's surface, gathered by place so that most are passed over together. Part frame.
class SurfaceBlocks
{
public:
  struct Block
  {
    Eigen::Vector3f center;
    float radius;
    std::size_t begin;
    std::size_t end;
  };

  explicit SurfaceBlocks(const std::vector<Eigen::Vector3f>& points);

  /// The point that lies deepest in the body, or nearest to it, if nearer than `limit`; else `limit` is left.
  /// \param planes of the body, part frame
  void deepest(const Planes& planes, float& limit, Eigen::Vector3f& point) const;

  const std::vector<Block>& blocks() const { return blocks_; }
  const std::vector<Eigen::Vector3f>& points() const { return points_; }
  const Eigen::AlignedBox3f& box() const { return box_; }

private:
  std::vector<Eigen::Vector3f> points_;
  std::vector<Block> blocks_;
  Eigen::AlignedBox3f box_;
};
}  // namespace bin_picking
