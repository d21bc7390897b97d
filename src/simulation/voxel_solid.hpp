// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking::simulation
{
/// A closed mesh as cubes: which of them lie inside, and how far the others are from it.
class VoxelSolid
{
public:
  /// \param resolution cubes along the longest edge of the bounding box
  VoxelSolid(const TriangleMesh& mesh, int resolution);

  const Eigen::Vector3i& size() const { return size_; }
  double edge() const { return edge_; }
  /// Corner (0, 0, 0) of cube (0, 0, 0), metres.
  const Eigen::Vector3d& origin() const { return origin_; }
  Eigen::Vector3d center(const Eigen::Vector3i& cube) const
  {
    return origin_ + edge_ * (cube.cast<double>() + Eigen::Vector3d::Constant(0.5));
  }
  bool inside(const Eigen::Vector3i& cube) const { return inside_[index(cube)] != 0; }
  /// From the cube's centre to the centre of the nearest cube inside, metres; 0 inside.
  double distance(const Eigen::Vector3i& cube) const { return edge_ * static_cast<double>(distance_[index(cube)]); }

private:
  std::size_t index(const Eigen::Vector3i& cube) const
  {
    return (static_cast<std::size_t>(cube.z()) * static_cast<std::size_t>(size_.y()) +
            static_cast<std::size_t>(cube.y())) *
               static_cast<std::size_t>(size_.x()) +
           static_cast<std::size_t>(cube.x());
  }
  void fill(const TriangleMesh& mesh);
  void measureDistances();

  Eigen::Vector3i size_;
  double edge_ = 0;
  Eigen::Vector3d origin_;
  std::vector<std::uint8_t> inside_;
  std::vector<float> distance_;  ///< in edges
};
}  // namespace bin_picking::simulation
