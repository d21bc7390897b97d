// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace bin_picking
{
/// A point with the number of its voxel: row by row, layer by layer.
struct VoxelMember
{
  std::uint64_t voxel;
  std::uint32_t point;
};

/// All points, voxel by voxel; within a voxel in their own order. Voxels are cubes of edge `leaf` on a lattice that
/// goes through the origin. \throws ParameterError the points lie more than two million voxels apart
std::vector<VoxelMember> voxelOrder(const std::vector<Eigen::Vector3f>& points, double leaf);
}  // namespace bin_picking
