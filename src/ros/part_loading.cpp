// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "part_loading.hpp"

#include <set>

#include "bin_picking_perception/common/error.hpp"
#include "resource_path.hpp"

namespace bin_picking_ros
{
std::vector<bin_picking::PartDefinition> loadParts(const std::vector<std::string>& directories)
{
  std::vector<bin_picking::PartDefinition> parts;
  std::set<std::string> names;
  for (const std::string& directory : directories)
  {
    parts.push_back(bin_picking::loadPart(resolveResource(directory)));
    if (!names.insert(parts.back().name).second)
      throw bin_picking::ParameterError("Two entries of the parameter parts are named " + parts.back().name +
                                        "; names must differ.");
  }
  return parts;
}
}  // namespace bin_picking_ros
