// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <array>
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
    Sphere around;
    std::size_t begin;
    std::size_t end;
  };

  explicit SurfaceBlocks(const std::vector<Eigen::Vector3f>& points);

  /// The point that lies deepest in the body, or nearest to it, if nearer than `limit`; else `limit` is left.
  /// \param planes of the body, part frame
  void deepest(const Planes& planes, float& limit, Eigen::Vector3f& point) const;

  const std::vector<Block>& blocks() const { return blocks_; }
  /// Around points that lie within few millimetres: together they enclose all.
  const std::vector<Sphere>& patches() const { return patches_; }
  /// \param index from a block's begin to before its end
  Eigen::Vector3f point(std::size_t index) const { return points_[index]; }
  /// Of the points from there on, coordinate by coordinate. From a block's begin on they can be read BLOCK at a time:
  /// behind its end the last one is repeated.
  std::array<const float*, 3> coordinates(std::size_t index) const
  {
    return {&points_.x[index], &points_.y[index], &points_.z[index]};
  }
  /// The same of the middles of the blocks from there on; what is behind the last block is no block's.
  std::array<const float*, 3> middles(std::size_t block) const
  {
    return {&centers_.x[block], &centers_.y[block], &centers_.z[block]};
  }
  const Eigen::AlignedBox3f& box() const { return box_; }

private:
  /// Coordinate by coordinate, so that many are compared at once.
  struct Coordinates
  {
    std::vector<float> x, y, z;

    void add(const Eigen::Vector3f& p);
    /// Repeats the last point up to a number that is computed at once.
    void fillUp();
    Eigen::Vector3f operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
  };

  void addBlock(const Eigen::Vector3f* points, std::size_t count);
  bool isApart(const Planes& planes, float distance) const;

  Coordinates points_;   ///< each block begins at one of the multiples that fillUp() leaves
  Coordinates centers_;  ///< of the blocks
  std::vector<Block> blocks_;
  std::vector<Sphere> patches_;
  Eigen::AlignedBox3f box_;
};
}  // namespace bin_picking
