// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "bin_picking_perception/model/part.hpp"

namespace bin_picking
{
/// Points of which every point of the part is a symmetric image, to within `spacing` (metres) and 30 degrees of the
/// normal: of a solid of revolution one profile. As references of the feature table they find every pose up to
/// symmetry, and cost a share of the memory and of the votes. Indices, ascending; empty for a part without symmetry.
std::vector<std::uint32_t> referencesUpToSymmetry(const OrientedPoints& points, const Symmetry& symmetry,
                                                  double spacing);
}  // namespace bin_picking
