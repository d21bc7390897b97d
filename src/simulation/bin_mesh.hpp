// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "bin_picking_perception/model/mesh.hpp"
#include "bin_picking_perception/scene/bin.hpp"

namespace bin_picking::simulation
{
/// Floor, four walls and the square table on which the bin stands, in the frame of the bin.
/// \param table_size edge of the table, metres; 0: none
TriangleMesh meshOf(const Bin& bin, double table_size);
}  // namespace bin_picking::simulation
