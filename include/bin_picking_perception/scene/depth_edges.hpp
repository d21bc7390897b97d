// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
class Executor;
struct ConnectedRuns;

/// A pixel where a surface ends in front of something farther away: a point of an outline.
struct DepthEdge
{
  int column = 0;
  Eigen::Vector2f outward = Eigen::Vector2f::UnitX();  ///< in the picture, away from the surface, unit
};

constexpr double MIN_EDGE_DROP = 0.5;  ///< of the leaf, noise not counted: a smaller drop in depth is no end of a part

/// The edges of a grid, row by row.
struct DepthEdges
{
  std::vector<std::vector<DepthEdge>> rows;  ///< in order of the columns
};

/// A direction in the picture as one across the ray of `point`, unit.
Eigen::Vector3f acrossRay(const Eigen::Vector3f& point, const Eigen::Vector2f& in_picture);

/// Pixels of `grid` beside which `surroundings` (the same grid with what lies outside of the region) drop by more than
/// `min_drop` metres. The far side is looked for over a few pixels, because sensors lose the rim itself; where nothing
/// was measured beyond (a shadow), or where what follows is nearer (the surface is only hidden there), is no edge.
/// \param runs of `grid`
DepthEdges findDepthEdges(const DepthGrid& grid, const DepthGrid& surroundings, const ConnectedRuns& runs,
                          double min_drop, const Executor& executor);
}  // namespace bin_picking
