// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/near_symmetry.hpp"

#include <algorithm>
#include <cmath>

#include "symmetry_axes.hpp"

namespace bin_picking
{
namespace
{
constexpr int STEPS = 24;            // of a turn
constexpr double MAX_BROKEN = 0.45;  // share of the surface: beyond it, poses have little in common
constexpr std::size_t MAX_POINTS = 1000;

double brokenShare(const OrientedPoints& surface, const DistanceField& field, const Pose& T, double tolerance)
{
  const Eigen::Isometry3f motion = T.cast<float>();
  const std::size_t step = std::max<std::size_t>(1, surface.size() / MAX_POINTS);
  int broken = 0;
  int tested = 0;
  for (std::size_t i = 0; i < surface.size(); i += step, ++tested)
    broken += std::abs(field.at(motion * surface.points[i])) > static_cast<float>(tolerance);
  return static_cast<double>(broken) / std::max(1, tested);
}

bool isDeclared(const Pose& T, const Symmetry& declared, const OrientedPoints& surface, double tolerance)
{
  const Pose nearest = nearestEquivalent(T, Pose::Identity(), declared);
  double farthest = 0;
  const std::size_t step = std::max<std::size_t>(1, surface.size() / MAX_POINTS);
  for (std::size_t i = 0; i < surface.size(); i += step)
  {
    const Eigen::Vector3d p = surface.points[i].cast<double>();
    farthest = std::max(farthest, (nearest * p - p).norm());
  }
  return farthest < tolerance;
}
}  // namespace

std::vector<NearSymmetry> findNearSymmetries(const OrientedPoints& surface, const DistanceField& field,
                                             const Symmetry& declared, double tolerance)
{
  std::vector<NearSymmetry> found;
  for (const Symmetry::Axis& axis : candidateAxes(Inertia(surface.points)))
    for (int k = 1; k < STEPS; ++k)
    {
      const Pose T = rotationAbout(axis, 2 * M_PI * k / STEPS);
      const double broken = brokenShare(surface, field, T, tolerance);
      if (broken < MAX_BROKEN && !isDeclared(T, declared, surface, tolerance))
        found.push_back({T, axis, broken});
    }
  return found;
}
}  // namespace bin_picking
