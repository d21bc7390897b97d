// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "../common/yaml_reader.hpp"
#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/grasping/gripper.hpp"

namespace bin_picking
{
namespace
{
constexpr int GRIPPER_FORMAT = 1;

/// Tables rise, and reach from the smallest to the largest opening: nothing is extrapolated.
template <typename Row>
void checkTable(const YamlMap& yaml, const std::string& key, const std::vector<Row>& table, const Gripper& gripper)
{
  for (std::size_t i = 1; i < table.size(); ++i)
    if (!(table[i].opening > table[i - 1].opening))
      yaml.fail(key, "the openings of '" + key + "' must rise from row to row, but " +
                         std::to_string(table[i].opening) + " m follows " + std::to_string(table[i - 1].opening) +
                         " m");
  if (table.size() > 1 &&
      !(table.front().opening <= gripper.min_opening && table.back().opening >= gripper.max_opening))
    yaml.fail(key, "'" + key + "' must reach from the smallest to the largest opening (" +
                       std::to_string(gripper.min_opening) + " to " + std::to_string(gripper.max_opening) +
                       " m), but it goes from " + std::to_string(table.front().opening) + " to " +
                       std::to_string(table.back().opening) + " m");
}

ConvexBody readBox(const YamlMap& yaml, const std::string& name)
{
  yaml.allowKeys({"center", "size"});
  const Eigen::Vector3d size = yaml.vector("size", "m");
  if (!(size.minCoeff() > 0))
    yaml.fail("size", "the 'size' of the box '" + name + "' must be positive in each direction, metres");
  return makeBox(yaml.vector("center", "m"), size);
}

/// The hull of a mesh that is drawn in the tool0 frame.
ConvexBody readMesh(const YamlMap& yaml, const std::string& name, const std::string& gripper_file)
{
  yaml.allowKeys({"file", "unit"});
  const std::filesystem::path file = std::filesystem::path(gripper_file).parent_path() / yaml.text("file");
  LengthUnit unit = LengthUnit::Metre;
  try
  {
    unit = parseLengthUnit(yaml.text("unit"));
  }
  catch (const ParameterError& error)
  {
    yaml.fail("unit", error.what());
  }
  try
  {
    std::vector<Eigen::Vector3d> points;
    for (const Eigen::Vector3f& v : loadMesh(file.string(), unit).vertices)
      points.push_back(v.cast<double>());
    return makeHull(points);
  }
  catch (const Error& error)
  {
    yaml.fail("file", "the mesh of the body '" + name + "' cannot be used: " + error.what());
  }
}

GripperBody::Placement readPlacement(const YamlMap& yaml)
{
  yaml.allowKeys({"opening", "offset", "angle_deg"});
  GripperBody::Placement placement;
  placement.opening = yaml.number("opening", "m");
  if (yaml.has("offset"))
    placement.offset = yaml.vector("offset", "m");
  placement.angle = yaml.number("angle_deg", "", 0) * M_PI / 180;
  return placement;
}

GripperBody readBody(const YamlMap& yaml, const Gripper& gripper, const std::string& gripper_file)
{
  yaml.allowKeys({"name", "box", "mesh", "moves", "pivot", "touches_part"});
  GripperBody body;
  body.name = yaml.text("name");
  if (yaml.has("box") == yaml.has("mesh"))
    yaml.fail("name", "the body '" + body.name + "' must have either a 'box' or a 'mesh'");
  body.shape =
      yaml.has("box") ? readBox(yaml.map("box"), body.name) : readMesh(yaml.map("mesh"), body.name, gripper_file);
  if (yaml.has("moves"))
  {
    body.placements.clear();
    for (const YamlMap& row : yaml.list("moves"))
      body.placements.push_back(readPlacement(row));
    if (body.placements.size() < 2)
      yaml.fail("moves", "'moves' of '" + body.name + "' needs at least two openings; leave it out if nothing moves");
    checkTable(yaml, "moves", body.placements, gripper);
  }
  if (yaml.has("pivot"))
    body.pivot = yaml.vector("pivot", "m");
  body.touches_part = yaml.flag("touches_part", false);
  return body;
}

void readOpenings(const YamlMap& yaml, Gripper& gripper)
{
  const std::string kind = yaml.text("kind");
  if (kind != "fingers" && kind != "suction")
    yaml.fail("kind", "'kind' is '" + kind + "', but it must be 'fingers' or 'suction'");
  gripper.kind = kind == "suction" ? Gripper::Kind::Suction : Gripper::Kind::Fingers;
  if (gripper.kind == Gripper::Kind::Suction)
  {
    for (const char* const key : {"min_opening", "max_opening"})
      if (yaml.has(key))
        yaml.fail(key, std::string("a suction cup has no '") + key + "'; leave it out");
    return;
  }
  gripper.min_opening = yaml.number("min_opening", "m", 0);
  gripper.max_opening = yaml.number("max_opening", "m");
  if (!(gripper.min_opening >= 0))
    yaml.fail("min_opening",
              "'min_opening' is " + std::to_string(gripper.min_opening) + " m, but it must be 0 or more");
  if (!(gripper.max_opening > gripper.min_opening))
    yaml.fail("max_opening", "'max_opening' is " + std::to_string(gripper.max_opening) +
                                 " m, but it must be larger than 'min_opening', " +
                                 std::to_string(gripper.min_opening) + " m");
}

void readTip(const YamlMap& yaml, Gripper& gripper)
{
  yaml.allowKeys({"position_xy", "rotation_z_deg", "height"});
  if (yaml.has("position_xy"))
  {
    const std::vector<double> xy = yaml.numbers("position_xy", 2, "m");
    gripper.tip_xy = {xy[0], xy[1]};
  }
  const double turn = yaml.number("rotation_z_deg", "", 0) * M_PI / 180;
  gripper.R_tool0_tip = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  gripper.tip_heights.clear();
  for (const std::vector<double>& row : yaml.rows("height", 2, "m"))
    gripper.tip_heights.push_back({row[0], row[1]});
  if (gripper.tip_heights.empty())
    yaml.fail("height", "'height' has no rows; give [opening, height] at least once");
  checkTable(yaml, "height", gripper.tip_heights, gripper);
}
}  // namespace

Gripper loadGripper(const std::string& path)
{
  const YamlMap yaml = YamlMap::load(path);
  yaml.allowKeys({"format", "name", "kind", "min_opening", "max_opening", "tool0_to_tip", "bodies"});
  if (yaml.integer("format") != GRIPPER_FORMAT)
    yaml.fail("format", "'format' is " + yaml.text("format") + ", but this program reads gripper files of format " +
                            std::to_string(GRIPPER_FORMAT));
  Gripper gripper;
  gripper.name = yaml.text("name");
  readOpenings(yaml, gripper);
  readTip(yaml.map("tool0_to_tip"), gripper);
  for (const YamlMap& entry : yaml.list("bodies"))
    gripper.bodies.push_back(readBody(entry, gripper, path));
  if (gripper.bodies.empty())
    yaml.fail("bodies",
              "the gripper has no 'bodies'; without them no collision would be seen: add at least the fingers");
  if (std::none_of(gripper.bodies.begin(), gripper.bodies.end(), [](const GripperBody& b) { return b.touches_part; }))
    yaml.fail("bodies",
              "no body has 'touches_part: true'; mark the finger pads (or the lip of the suction cup), which "
              "shall touch the part");
  return gripper;
}
}  // namespace bin_picking
