// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "gripper_set.hpp"

#include <set>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parameters.hpp"
#include "resource_path.hpp"
#include "return_code.hpp"

namespace bin_picking_ros
{
GripperSet GripperSet::load(const std::string& resource, std::vector<std::string> others)
{
  others.insert(others.begin(), resource);
  std::vector<bin_picking::Gripper> grippers;
  std::set<std::string> files, names;
  for (const std::string& entry : others)
  {
    const std::string file = resolveResource(entry);
    if (!files.insert(file).second)
      continue;  // the default one may also be in the list
    grippers.push_back(bin_picking::loadGripper(file));
    if (!names.insert(grippers.back().name).second)
      throw bin_picking::ParameterError("Two of the grippers are named " + grippers.back().name + " (the second in " +
                                        file + "); names must differ, requests tell them apart by it.");
  }
  return GripperSet(std::move(grippers));
}

const bin_picking::Gripper& GripperSet::find(const std::string& name) const
{
  if (name.empty())
    return grippers_.front();
  std::vector<std::string> known;
  std::string loaded;
  for (const bin_picking::Gripper& gripper : grippers_)
  {
    if (gripper.name == name)
      return gripper;
    known.push_back(gripper.name);
    loaded += (loaded.empty() ? "" : ", ") + gripper.name;
  }
  const std::string near = bin_picking::didYouMean(name, known);
  throw RequestError(ReturnCode::GRIPPER_UNKNOWN, "The gripper " + name + " is not loaded" +
                                                      (near.empty() ? "" : "; did you mean " + near + "?") +
                                                      " (loaded: " + loaded + ").");
}
}  // namespace bin_picking_ros
