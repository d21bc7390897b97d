// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/near_symmetry.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace bin_picking
{
namespace
{
constexpr int STEPS = 24;            // of a turn
constexpr double MAX_BROKEN = 0.45;  // share of the surface: beyond it, poses have little in common
constexpr std::size_t MAX_POINTS = 1000;

/// Axes of the box, of the drawing and of inertia, each line once.
std::vector<Symmetry::Axis> candidateAxes(const OrientedPoints& surface)
{
  constexpr double SAME_DIRECTION = 0.999;
  Eigen::AlignedBox3d box;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& p : surface.points)
  {
    box.extend(p.cast<double>());
    mean += p.cast<double>() / static_cast<double>(surface.size());
  }
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& p : surface.points)
    scatter += (p.cast<double>() - mean) * (p.cast<double>() - mean).transpose();
  const Eigen::Matrix3d principal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors();
  std::vector<Symmetry::Axis> axes;
  for (int k = 0; k < 3; ++k)
  {
    axes.push_back({Eigen::Vector3d::Unit(k), box.center()});
    axes.push_back({principal.col(k), mean});
    axes.push_back({Eigen::Vector3d::Unit(k), mean});
    axes.push_back({Eigen::Vector3d::Unit(k), Eigen::Vector3d::Zero()});  // where drawings like to put them
  }
  std::vector<Symmetry::Axis> distinct;
  for (const Symmetry::Axis& axis : axes)
  {
    const bool known = std::any_of(distinct.begin(), distinct.end(), [&](const Symmetry::Axis& other) {
      const double apart = (axis.origin - other.origin).cross(other.direction).norm();
      return std::abs(axis.direction.dot(other.direction)) > SAME_DIRECTION && apart < 0.01 * box.diagonal().norm();
    });
    if (!known)
      distinct.push_back(axis);
  }
  return distinct;
}

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
  for (const Symmetry::Axis& axis : candidateAxes(surface))
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
