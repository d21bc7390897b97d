// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace bin_picking
{
/// A point with the place of its voxel, counted from the lowest that holds a point.
struct VoxelMember
{
  std::array<std::uint32_t, 3> voxel;  ///< column, row, layer
  std::uint32_t point;
};

/// All points, voxel by voxel: along the columns, row by row, layer by layer; within a voxel in their own order. Voxels
/// are cubes of edge `leaf` on a lattice that goes through the origin.
/// \throws ParameterError the points reach over more voxels than 32 bits count
std::vector<VoxelMember> voxelOrder(const std::vector<Eigen::Vector3f>& points, double leaf);
}  // namespace bin_picking
