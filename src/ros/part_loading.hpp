// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/model/part.hpp"

namespace bin_picking_ros
{
/// The definitions of all parts, in order. \param directories as for resolveResource
/// \throws bin_picking::FileError a missing or wrong part.yaml; bin_picking::ParameterError two parts of one name
std::vector<bin_picking::PartDefinition> loadParts(const std::vector<std::string>& directories);
}  // namespace bin_picking_ros
