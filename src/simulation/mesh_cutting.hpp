// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking::simulation
{
using Triangle = std::array<Eigen::Vector3d, 3>;

/// What of a closed surface lies on one side of the plane p[axis] = at. Triangles in the plane belong to the side on
/// which the body is. \param side 1: above, -1: below
std::vector<Triangle> clip(const std::vector<Triangle>& surface, int axis, double at, int side);

/// What lies within a box of the solid that a closed mesh encloses.
struct Block
{
  Eigen::AlignedBox3d box;
  std::vector<Eigen::Vector3d> corners;  ///< their hull is that of the block
};

/// Cuts the solid along planes of its axes: evenly, `size` apart, and along its largest flat faces. Blocks without a
/// part of the solid are left out.
std::vector<Block> cutIntoBlocks(const TriangleMesh& mesh, double size);
}  // namespace bin_picking::simulation
