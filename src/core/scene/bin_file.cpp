// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <cmath>

#include "../common/yaml_reader.hpp"
#include "bin_picking_perception/scene/bin.hpp"

namespace bin_picking
{
namespace
{
Pose readPose(const YamlMap& yaml)
{
  constexpr double NORM_TOLERANCE = 1e-3;
  yaml.allowKeys({"position", "orientation"});
  const std::vector<double> q = yaml.numbers("orientation", 4, "");
  const Eigen::Quaterniond orientation(q[3], q[0], q[1], q[2]);
  if (!(std::abs(orientation.norm() - 1) <= NORM_TOLERANCE))
    yaml.fail("orientation", "the quaternion [qx, qy, qz, qw] has the length " + std::to_string(orientation.norm()) +
                                 ", but it must be 1 within 0.001; write more digits, and w last");
  Pose pose = Pose::Identity();
  pose.linear() = orientation.normalized().toRotationMatrix();
  pose.translation() = yaml.vector("position", "m");
  return pose;
}
}  // namespace

Bin loadBin(const std::string& path)
{
  const YamlMap yaml = YamlMap::load(path);
  yaml.allowKeys({"pose", "inner_size", "wall_thickness"});
  Bin bin;
  bin.T_camera_bin = readPose(yaml.map("pose"));
  bin.inner_size = yaml.vector("inner_size", "m");
  if (!(bin.inner_size.minCoeff() > 0))
    yaml.fail("inner_size", "'inner_size' must be positive in each direction: length, width and height in metres");
  bin.wall_thickness = yaml.number("wall_thickness", "m", bin.wall_thickness);
  if (!(bin.wall_thickness > 0))
    yaml.fail("wall_thickness",
              "'wall_thickness' is " + std::to_string(bin.wall_thickness) + " m, but it must be positive");
  return bin;
}
}  // namespace bin_picking
