// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/scene/depth_edges.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
/// Where surfaces end: of every depth edge the point half a pixel beyond it and, as its "normal", the direction in
/// which the surface ends, within the surface's plane. At the rim of a face that direction belongs to the part,
/// whatever the view (the boundary points of Choi et al. 2012). Where a round surface turns away from the camera it
/// does not, and a face that is seen at a slant across its rim hides where it ends: such edges are left out.
/// \param normals per pixel of the grid
/// \param edges of the grid
/// \return frame of the grid, metres, in the order of the edges, without curvature
OrientedPoints edgePoints(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& normals, const DepthEdges& edges);
}  // namespace bin_picking
