// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/model/mesh.hpp"
#include "bin_picking_perception/model/near_symmetry.hpp"
#include "bin_picking_perception/model/part.hpp"
#include "binary_stream.hpp"

namespace bin_picking
{
/// \throws std::runtime_error with the text, unless the condition holds
void require(bool condition, const char* what);

// The parts of a model that describe the shape, as they stand in its file. Reading throws std::runtime_error where the
// data end too early or do not fit together.
void write(BinaryWriter& out, const Symmetry& symmetry);
Symmetry readSymmetry(BinaryReader& in);
void write(BinaryWriter& out, const std::vector<std::string>& texts);
std::vector<std::string> readTexts(BinaryReader& in);
void write(BinaryWriter& out, const TriangleMesh& mesh);
TriangleMesh readMesh(BinaryReader& in);
void write(BinaryWriter& out, const std::vector<NearSymmetry>& turns);
std::vector<NearSymmetry> readNearSymmetries(BinaryReader& in);
}  // namespace bin_picking
