// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/error.hpp"
#include "part_file.hpp"

namespace bin_picking
{
namespace
{
constexpr int MAX_ORDER = 120;

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
  return Pose(Eigen::Translation3d(axis.origin) * Eigen::AngleAxisd(2 * M_PI / order, axis.direction) *
              Eigen::Translation3d(-axis.origin));
}

/// Whether a rotation maps the axis of revolution onto itself.
bool keepsAxis(const Pose& rotation, const Symmetry::Axis& axis)
{
  constexpr double DIRECTION_TOLERANCE = 0.002;  // rad
  constexpr double DISTANCE_TOLERANCE = 1e-5;    // metres
  const Eigen::Vector3d moved = rotation.linear() * axis.direction;
  const Eigen::Vector3d offset = rotation * axis.origin - axis.origin;
  return moved.cross(axis.direction).norm() < DIRECTION_TOLERANCE &&
         offset.cross(axis.direction).norm() < DISTANCE_TOLERANCE;
}

/// Turns about the axis of revolution are part of the revolution, and all flips of it are one up to such a turn.
std::vector<Pose> flipOnly(const std::vector<Pose>& rotations, const Symmetry::Axis& axis)
{
  std::vector<Pose> remaining = {Pose::Identity()};
  const auto flip = std::find_if(rotations.begin(), rotations.end(),
                                 [&](const Pose& g) { return (g.linear() * axis.direction).dot(axis.direction) < 0; });
  if (flip != rotations.end())
    remaining.push_back(*flip);
  return remaining;
}
}  // namespace

Symmetry readSymmetry(const YamlMap& yaml)
{
  yaml.allowKeys({"discrete", "continuous"});
  Symmetry symmetry;
  if (yaml.has("continuous"))
  {
    const YamlMap continuous = yaml.map("continuous");
    continuous.allowKeys({"axis", "origin"});
    symmetry.continuous = readAxis(continuous);
  }
  if (!yaml.has("discrete"))
    return symmetry;
  std::vector<Pose> generators;
  for (const YamlMap& entry : yaml.list("discrete"))
  {
    generators.push_back(readRotation(entry));
    if (symmetry.continuous && !keepsAxis(generators.back(), *symmetry.continuous))
      entry.fail("axis",
                 "this rotation moves the axis of revolution; its axis must be that axis, or cross it at a "
                 "right angle (with order 2)");
  }
  if (symmetry.continuous)
  {
    symmetry.discrete = flipOnly(generators, *symmetry.continuous);
    return symmetry;
  }
  try
  {
    symmetry.discrete = closeUnderComposition(generators);
  }
  catch (const ParameterError& error)
  {
    yaml.fail("discrete", error.what());
  }
  return symmetry;
}
}  // namespace bin_picking
