// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/common/parallel.hpp"

namespace bin_picking
{
/// Per point whether the surface bends sharply within `radius`: a normal that is measured there by a plane fit of this
/// radius may lie anywhere between those of the two faces.
std::vector<std::uint8_t> nearCrease(const OrientedPoints& surface, double radius, const Executor& executor);
}  // namespace bin_picking
