// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
class Executor;

/// Regions between depth discontinuities: a watershed over the distance to the nearest edge, whose basins join only
/// where no depth edge lies between them and the passage is not narrower than `neck` times the narrower basin. Labels 1
/// ... n, 0 where nothing was measured or only a speck.
std::vector<std::int32_t> depthEdgeSegments(const DepthGrid& grid, double edge_depth, double neck,
                                            const Executor& executor);
}  // namespace bin_picking
