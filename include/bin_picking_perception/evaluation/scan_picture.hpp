// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
/// Writes the shaded depth with each labelled object in a colour of its own; PNG or JPEG by the file's ending.
/// \param labels per pixel, -1: none, shown gray. \throws FileError cannot be written
void saveScanPicture(const DepthGrid& grid, const std::vector<std::int32_t>& labels, const std::string& path);
}  // namespace bin_picking
