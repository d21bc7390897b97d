// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "../common/yaml_reader.hpp"
#include "bin_picking_perception/model/part.hpp"

namespace bin_picking
{
/// The `symmetry:` map of part.yaml. \param directory to which its files are relative \throws FileError
Symmetry readSymmetry(const YamlMap& yaml, const std::string& directory);

/// The `grasps:` list of part.yaml. \throws FileError
std::vector<GraspDefinition> readGrasps(const YamlMap& part);
}  // namespace bin_picking
