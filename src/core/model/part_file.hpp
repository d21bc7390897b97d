// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "../common/yaml_reader.hpp"
#include "bin_picking_perception/model/part.hpp"

namespace bin_picking
{
/// The `symmetry:` map of part.yaml. \param part its directory is where files are looked for; a file that is read is
/// added to its files \throws FileError
Symmetry readSymmetry(const YamlMap& yaml, PartDefinition& part);

/// The `grasps:` list of part.yaml. \throws FileError
std::vector<GraspDefinition> readGrasps(const YamlMap& part);
}  // namespace bin_picking
