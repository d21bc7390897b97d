// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/part.hpp"
#include "symmetry_group.hpp"

namespace bin_picking
{
namespace
{
constexpr std::size_t MAX_GROUP_SIZE = 120;
/// Two representatives whose rotations differ by less are equally near: the earlier one wins, whatever the rounding.
constexpr double TRACE_TIE = 1e-9;

double angleOf(const Eigen::Matrix3d& R) { return Eigen::AngleAxisd(R).angle(); }

bool contains(const std::vector<Pose>& group, const Pose& element, const SymmetryTolerance& tolerance)
{
  return std::any_of(group.begin(), group.end(), [&](const Pose& g) {
    return (g.translation() - element.translation()).norm() < tolerance.position &&
           angleOf(g.linear().transpose() * element.linear()) < tolerance.angle;
  });
}

/// The angle about the axis that brings R nearest to the identity: trace(R * R(axis, t)) is a + b cos t + c sin t.
double nearestAngle(const Eigen::Matrix3d& R, const Eigen::Vector3d& axis)
{
  Eigen::Matrix3d cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  const double c = (R * cross).trace();
  const double b = R.trace() - axis.dot(R * axis);
  return std::atan2(c, b);
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

Pose rotationAbout(const Symmetry::Axis& axis, double angle)
{
  return Pose(Eigen::Translation3d(axis.origin) * Eigen::AngleAxisd(angle, axis.direction) *
              Eigen::Translation3d(-axis.origin));
}

std::vector<Pose> Symmetry::sampled(int steps) const
{
  if (steps < 1)
    throw ParameterError("the number of steps about a symmetry axis is " + std::to_string(steps) +
                         ", but it must be at least 1");
  if (!continuous)
    return discrete;
  std::vector<Pose> all;
  for (int i = 0; i < steps; ++i)
    for (const Pose& element : discrete)
      all.push_back(rotationAbout(*continuous, 2 * M_PI * i / steps) * element);
  return all;
}

std::vector<Pose> closeUnderComposition(const std::vector<Pose>& generators)
{
  return closeUnderComposition(generators, SymmetryTolerance());
}

std::vector<Pose> closeUnderComposition(const std::vector<Pose>& generators, const SymmetryTolerance& tolerance)
{
  std::vector<Pose> group = {Pose::Identity()};
  // Every element of a finite group is a product of generators: extending each element by each of them finds all.
  for (std::size_t i = 0; i < group.size(); ++i)
    for (const Pose& generator : generators)
    {
      const Pose product = group[i] * generator;
      if (contains(group, product, tolerance))
        continue;
      if (group.size() == MAX_GROUP_SIZE)
        throw ParameterError("the symmetry rotations generate more than " + std::to_string(MAX_GROUP_SIZE) +
                             " poses; check that their axes meet in one point and at the right angles");
      group.push_back(product);
    }
  return group;
}

bool keepsAxis(const Pose& rotation, const Symmetry::Axis& axis, const SymmetryTolerance& tolerance)
{
  const Eigen::Vector3d moved = rotation.linear() * axis.direction;
  const Eigen::Vector3d offset = rotation * axis.origin - axis.origin;
  return moved.cross(axis.direction).norm() < tolerance.angle &&
         offset.cross(axis.direction).norm() < tolerance.position;
}

Symmetry generateSymmetry(const std::vector<Pose>& rotations, const std::optional<Symmetry::Axis>& axis,
                          const SymmetryTolerance& tolerance)
{
  return {axis ? flipOnly(rotations, *axis) : closeUnderComposition(rotations, tolerance), axis};
}

Pose nearestEquivalent(const Pose& T_camera_object, const Pose& reference, const Symmetry& symmetry)
{
  Pose best = T_camera_object;
  double best_trace = -2;
  for (const Pose& element : symmetry.discrete)
  {
    Pose candidate = T_camera_object * element;
    if (symmetry.continuous)
    {
      const Eigen::Matrix3d R = reference.linear().transpose() * candidate.linear();
      candidate = candidate * rotationAbout(*symmetry.continuous, nearestAngle(R, symmetry.continuous->direction));
    }
    const double trace = (reference.linear().transpose() * candidate.linear()).trace();
    if (trace > best_trace + TRACE_TIE)
    {
      best_trace = trace;
      best = candidate;
    }
  }
  return best;
}
}  // namespace bin_picking
