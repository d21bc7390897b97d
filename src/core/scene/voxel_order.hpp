// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace bin_picking
{
/// A point with the place of its voxel in the box of all.
struct VoxelMember
{
  std::uint64_t voxel;  ///< along the columns, row by row, layer by layer
  std::uint32_t point;
};

/// All points, voxel by voxel; within a voxel in their own order. Voxels are cubes of edge `leaf` on a lattice that
/// goes through the origin. \throws ParameterError the points reach over more voxels than can be counted: 2^24 along an
/// axis, 2^62 in their box
std::vector<VoxelMember> voxelOrder(const std::vector<Eigen::Vector3f>& points, double leaf);
}  // namespace bin_picking
