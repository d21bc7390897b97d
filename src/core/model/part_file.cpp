// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "../common/yaml_reader.hpp"
#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/model/part.hpp"
#include "bin_picking_perception/model/training_parameters.hpp"
#include "part_file.hpp"

namespace bin_picking
{
namespace
{
constexpr int PART_FORMAT = 1;

void readMesh(const YamlMap& yaml, PartDefinition& part)
{
  yaml.allowKeys({"file", "unit"});
  const std::filesystem::path file = yaml.text("file");
  part.mesh_file = (file.is_absolute() ? file : part.directory / file).string();
  if (!yaml.has("unit"))
    yaml.fail("unit", "the mesh has no 'unit'; files do not tell in which unit they were drawn: add m, cm, mm or inch");
  try
  {
    part.mesh_unit = parseLengthUnit(yaml.text("unit"));
  }
  catch (const ParameterError& error)
  {
    yaml.fail("unit", error.what());
  }
}

Eigen::Vector3d readExpectedSize(const YamlMap& yaml)
{
  Eigen::Vector3d size = yaml.vector("expected_size", "m");
  if (!(size.minCoeff() > 0))
    yaml.fail("expected_size", "'expected_size' must be positive in each direction, metres");
  return size;
}

/// Reports mistyped training parameters now, at their line, and not only when the part is trained.
std::string readTraining(const YamlMap& yaml, const std::string& path)
{
  std::string text = yaml.yaml("training");
  TrainingParameters parameters;
  try
  {
    setParametersFromYaml(visitor(parameters), text, path);
  }
  catch (const ParameterError& error)
  {
    throw FileError(error.what());
  }
  return text;
}
}  // namespace

PartDefinition loadPart(const std::string& path)
{
  std::error_code ignored;
  std::filesystem::path file = path;
  if (std::filesystem::is_directory(file, ignored))
    file /= "part.yaml";
  const YamlMap yaml = YamlMap::load(file.string());
  yaml.allowKeys({"format", "name", "mesh", "expected_size", "symmetry", "training", "grasps"});
  if (const int format = yaml.integer("format"); format != PART_FORMAT)
    yaml.fail("format", "the format is " + std::to_string(format) + ", but this program reads format " +
                            std::to_string(PART_FORMAT) + "; use the release that the file was written for");
  PartDefinition part;
  part.directory = file.has_parent_path() ? file.parent_path().string() : ".";
  part.name = yaml.text("name");
  readMesh(yaml.map("mesh"), part);
  part.files = {file.string(), part.mesh_file};
  if (yaml.has("expected_size"))
    part.expected_size = readExpectedSize(yaml);
  part.symmetry_stated = yaml.has("symmetry");
  if (part.symmetry_stated)
    part.symmetry = readSymmetry(yaml.map("symmetry"), part);
  if (yaml.has("training"))
    part.training_yaml = readTraining(yaml, file.string());
  if (yaml.has("grasps"))
    part.grasps = readGrasps(yaml);
  return part;
}

void checkExpectedSize(const PartDefinition& definition, const Eigen::Vector3d& size)
{
  if (!definition.expected_size)
    return;
  const auto text = [](const Eigen::Vector3d& v) {
    return "[" + std::to_string(v.x()) + ", " + std::to_string(v.y()) + ", " + std::to_string(v.z()) + "] m";
  };
  for (int k = 0; k < 3; ++k)
    if (std::abs(size[k] - (*definition.expected_size)[k]) > std::max(0.01 * (*definition.expected_size)[k], 0.0005))
      throw FileError("the mesh '" + definition.mesh_file + "' read in '" + toString(definition.mesh_unit) + "' is " +
                      text(size) + " large, but part.yaml expects " + text(*definition.expected_size) +
                      "; correct the unit, the file or expected_size");
}
}  // namespace bin_picking
