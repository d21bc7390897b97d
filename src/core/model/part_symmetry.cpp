// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <cmath>
#include <filesystem>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/models_info.hpp"
#include "part_file.hpp"
#include "symmetry_group.hpp"

namespace bin_picking
{
namespace
{
constexpr int MAX_ORDER = 120;
/// Of directions and origins that a person wrote with a few digits.
constexpr SymmetryTolerance AXIS_TOLERANCE = {0.002, 1e-5};

Symmetry::Axis readAxis(const YamlMap& yaml)
{
  return {yaml.direction("axis"), yaml.has("origin") ? yaml.vector("origin", "m") : Eigen::Vector3d::Zero()};
}

Pose readRotation(const YamlMap& yaml)
{
  yaml.allowKeys({"axis", "order", "origin"});
  const Symmetry::Axis axis = readAxis(yaml);
  const int order = yaml.integer("order");
  if (order < 2 || order > MAX_ORDER)
    yaml.fail("order", "'order' is " + std::to_string(order) + ", but it must lie in [2, " + std::to_string(MAX_ORDER) +
                           "]: the part looks the same after a turn by 360 degrees / order");
  return rotationAbout(axis, 2 * M_PI / order);
}

/// From a file of the BOP benchmark that describes the same mesh.
Symmetry readFromModelsInfo(const YamlMap& yaml, PartDefinition& part)
{
  yaml.allowKeys({"file", "id"});
  const std::string file = (std::filesystem::path(part.directory) / yaml.text("file")).string();
  const int id = yaml.integer("id");
  const auto models = loadModelsInfo(file);
  const auto found = models.find(id);
  if (found == models.end())
    yaml.fail("id", "'" + file + "' has no model " + std::to_string(id) + "; its ids lie in [" +
                        std::to_string(models.begin()->first) + ", " + std::to_string(models.rbegin()->first) + "]");
  part.files.push_back(file);
  return found->second.symmetry;
}
}  // namespace

Symmetry readSymmetry(const YamlMap& yaml, PartDefinition& part)
{
  yaml.allowKeys({"discrete", "continuous", "models_info"});
  if (yaml.has("models_info"))
  {
    if (yaml.has("discrete") || yaml.has("continuous"))
      yaml.fail("models_info", "the symmetry is given twice; keep 'models_info', or 'discrete' and 'continuous'");
    return readFromModelsInfo(yaml.map("models_info"), part);
  }
  std::optional<Symmetry::Axis> axis;
  if (yaml.has("continuous"))
  {
    const YamlMap continuous = yaml.map("continuous");
    continuous.allowKeys({"axis", "origin"});
    axis = readAxis(continuous);
  }
  std::vector<Pose> rotations;
  if (yaml.has("discrete"))
    for (const YamlMap& entry : yaml.list("discrete"))
    {
      rotations.push_back(readRotation(entry));
      if (axis && !keepsAxis(rotations.back(), *axis, AXIS_TOLERANCE))
        entry.fail("axis",
                   "this rotation moves the axis of revolution; its axis must be that axis, or cross it at a "
                   "right angle (with order 2)");
    }
  try
  {
    return generateSymmetry(rotations, axis);
  }
  catch (const ParameterError& error)
  {
    yaml.fail("discrete", error.what());
  }
}
}  // namespace bin_picking
