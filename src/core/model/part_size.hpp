// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking
{
/// Diameters that a part in a bin can have, metres.
constexpr double MIN_PART_DIAMETER = 0.002;
constexpr double MAX_PART_DIAMETER = 2.0;

/// \throws FileError missing, or a folder
void requireReadableFile(const std::string& path);

/// \param points metres, as read with `unit`
/// \throws FileError not finite, flat, or of a diameter that no part has: the message names the units that would fit
void checkPartShape(const std::vector<Eigen::Vector3f>& points, const std::string& path, LengthUnit unit);
}  // namespace bin_picking
