// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <string>

#include "virtual_cell.hpp"

namespace bin_picking::simulation
{
/// Writes one scene of a data set in the own format into a folder that exists: scene.pcd, bin.yaml, camera.json,
/// truth.json and the picture scene.png; docs/evaluation.md describes them.
/// \param seed as recorded in the truth. \throws FileError
void writeScene(const CellScan& scan, const VirtualCell& cell, std::uint32_t seed, const std::string& folder);

/// Whether a folder holds a scene that writeScene has written; a truth that a person wrote lacks the seed.
bool holdsVirtualScene(const std::string& folder);

/// A bin as bin files have it (see loadBin).
std::string toYaml(const Bin& bin);
}  // namespace bin_picking::simulation
