// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "../common/yaml_reader.hpp"
#include "bin_picking_perception/grasping/gripper.hpp"

namespace bin_picking
{
namespace
{
GripperBox readBox(const YamlMap& yaml)
{
  yaml.allowKeys({"name", "center", "size", "finger"});
  GripperBox box;
  box.name = yaml.text("name");
  box.center = yaml.vector("center", "m");
  box.size = yaml.vector("size", "m");
  if (!(box.size.minCoeff() > 0))
    yaml.fail("size", "the 'size' of the box '" + box.name + "' must be positive in each direction, metres");
  box.finger = yaml.integer("finger", box.finger);
  if (box.finger < -1 || box.finger > 1)
    yaml.fail("finger", "'finger' of the box '" + box.name + "' is " + std::to_string(box.finger) +
                            ", but it must be 0 (palm), 1 (moves along +Y) or -1 (moves along -Y)");
  return box;
}
}  // namespace

Gripper loadGripper(const std::string& path)
{
  const YamlMap yaml = YamlMap::load(path);
  yaml.allowKeys({"name", "max_opening", "boxes"});
  Gripper gripper;
  gripper.name = yaml.text("name");
  gripper.max_opening = yaml.number("max_opening", "m");
  if (!(gripper.max_opening > 0))
    yaml.fail("max_opening", "'max_opening' is " + std::to_string(gripper.max_opening) + " m, but it must be positive");
  for (const YamlMap& entry : yaml.list("boxes"))
    gripper.boxes.push_back(readBox(entry));
  if (gripper.boxes.empty())
    yaml.fail("boxes", "the gripper has no 'boxes'; without them no collision would be seen: add at least the fingers");
  return gripper;
}
}  // namespace bin_picking
