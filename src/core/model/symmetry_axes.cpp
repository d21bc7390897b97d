// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "symmetry_axes.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "even_directions.hpp"

namespace bin_picking
{
namespace
{
/// Moments of sampled symmetric surfaces agree better than this.
constexpr double SAME_MOMENT = 0.08;

bool agree(double a, double b) { return std::abs(a - b) < SAME_MOMENT * std::max(a, b); }

Eigen::Vector3f gradientAt(const DistanceField& field, const Eigen::Vector3f& p, float step)
{
  Eigen::Vector3f gradient;
  for (int k = 0; k < 3; ++k)
  {
    const Eigen::Vector3f offset = step * Eigen::Vector3f::Unit(k);
    gradient[k] = (field.at(p + offset) - field.at(p - offset)) / (2 * step);
  }
  return gradient;
}

/// One damped Gauss-Newton step of sum field(T p)^2 over small motions about `center`; what is off by more than the
/// gate does not count.
Pose improved(const std::vector<Eigen::Vector3f>& points, const DistanceField& field, const Pose& T,
              const Eigen::Vector3d& center, float gate)
{
  constexpr double DAMPING = 1e-4;  // of the mean pivot: a cylinder slides along itself freely
  Eigen::Matrix<double, 6, 6> normal_matrix = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  for (const Eigen::Vector3f& point : points)
  {
    const Eigen::Vector3d p = T * point.cast<double>();
    const float residual = field.at(p.cast<float>());
    if (std::abs(residual) >= gate)
      continue;
    const Eigen::Vector3d g = gradientAt(field, p.cast<float>(), 0.1f * field.band()).cast<double>();
    Eigen::Matrix<double, 6, 1> row;
    row << (p - center).cross(g), g;
    normal_matrix.selfadjointView<Eigen::Lower>().rankUpdate(row);
    right -= row * static_cast<double>(residual);
  }
  for (int block = 0; block < 6; block += 3)
  {
    const double mean = normal_matrix.diagonal().segment<3>(block).mean();
    normal_matrix.diagonal().segment<3>(block).array() += DAMPING * mean + 1e-12;
  }
  const Eigen::Matrix<double, 6, 1> x = normal_matrix.selfadjointView<Eigen::Lower>().ldlt().solve(right);
  const Eigen::Vector3d turn = x.head<3>();
  Pose motion = Pose::Identity();
  if (turn.norm() > 0)
    motion.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  motion.translation() = center - motion.linear() * center + x.tail<3>();
  return motion * T;
}
}  // namespace

Inertia::Inertia(const std::vector<Eigen::Vector3f>& surface)
{
  for (const Eigen::Vector3f& p : surface)
  {
    box.extend(p.cast<double>());
    center += p.cast<double>() / static_cast<double>(surface.size());
  }
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& p : surface)
    scatter += (p.cast<double>() - center) * (p.cast<double>() - center).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  moments = solver.eigenvalues();
  axes = solver.eigenvectors();
}

std::vector<Symmetry::Axis> candidateAxes(const Inertia& inertia)
{
  constexpr double SAME_DIRECTION = 0.999;
  std::vector<Symmetry::Axis> axes;
  for (int k = 0; k < 3; ++k)
  {
    axes.push_back({Eigen::Vector3d::Unit(k), inertia.box.center()});
    axes.push_back({inertia.axes.col(k), inertia.center});
    axes.push_back({Eigen::Vector3d::Unit(k), inertia.center});
    axes.push_back({Eigen::Vector3d::Unit(k), Eigen::Vector3d::Zero()});  // where drawings like to put them
  }
  std::vector<Symmetry::Axis> distinct;
  for (const Symmetry::Axis& axis : axes)
  {
    const bool known = std::any_of(distinct.begin(), distinct.end(), [&](const Symmetry::Axis& other) {
      const double apart = (axis.origin - other.origin).cross(other.direction).norm();
      return std::abs(axis.direction.dot(other.direction)) > SAME_DIRECTION &&
             apart < 0.01 * inertia.box.diagonal().norm();
    });
    if (!known)
      distinct.push_back(axis);
  }
  return distinct;
}

std::vector<Eigen::Vector3d> undecidedDirections(const Inertia& inertia)
{
  constexpr int RING = 36;      // steps of 5 degrees over half a turn
  constexpr int SPHERE = 1000;  // about 6 degrees apart
  const bool low = agree(inertia.moments[0], inertia.moments[1]);
  const bool high = agree(inertia.moments[1], inertia.moments[2]);
  std::vector<Eigen::Vector3d> directions;
  if (low && high)
  {
    directions = evenDirections(SPHERE);
    directions.resize(SPHERE / 2);  // an axis and its opposite are one
    return directions;
  }
  if (!low && !high)
    return directions;
  const Eigen::Vector3d a = inertia.axes.col(low ? 0 : 1);
  const Eigen::Vector3d b = inertia.axes.col(low ? 1 : 2);
  for (int k = 0; k < RING; ++k)
    directions.push_back(std::cos(M_PI * k / RING) * a + std::sin(M_PI * k / RING) * b);
  return directions;
}

double meanDistance(const std::vector<Eigen::Vector3f>& points, const DistanceField& field, const Pose& T)
{
  const Eigen::Isometry3f motion = T.cast<float>();
  double sum = 0;
  for (const Eigen::Vector3f& p : points)
    sum += static_cast<double>(std::abs(field.at(motion * p)));
  return sum / static_cast<double>(std::max<std::size_t>(1, points.size()));
}

Symmetry::Axis refinedAxis(const std::vector<Eigen::Vector3f>& points, const DistanceField& field,
                           const Symmetry::Axis& axis, double angle, double last_gate)
{
  constexpr int STEPS = 8;
  constexpr double SAME_ANGLE = 0.05;
  const double first_gate = 0.99 * static_cast<double>(field.band());
  const double shrinkage = std::min(1.0, std::pow(last_gate / first_gate, 1.0 / (STEPS - 1)));
  double gate = first_gate;
  Pose T = rotationAbout(axis, angle);
  for (int step = 0; step < STEPS; ++step, gate *= shrinkage)
    T = improved(points, field, T, axis.origin, static_cast<float>(gate));
  const Eigen::AngleAxisd turn(T.linear());
  const Eigen::Vector3d direction = turn.axis().dot(axis.direction) < 0 ? Eigen::Vector3d(-turn.axis()) : turn.axis();
  if (!T.matrix().allFinite() || std::abs(turn.angle() - angle) > SAME_ANGLE)
    return axis;
  // m = (I - R) d, where d leads from the old origin to the fixed line of p -> R p + t; across the axis, the inverse of
  // I - R is (1 + cot(angle / 2) axis x) / 2.
  const Eigen::Vector3d m = T * axis.origin - axis.origin;
  const Eigen::Vector3d across = m - m.dot(direction) * direction;
  return {direction, axis.origin + (across + direction.cross(across) / std::tan(angle / 2)) / 2};
}

double brokenShare(const std::vector<Eigen::Vector3f>& points, const DistanceField& field, const Pose& T,
                   double tolerance)
{
  const Eigen::Isometry3f motion = T.cast<float>();
  const auto limit = static_cast<float>(tolerance);
  const auto broken = std::count_if(points.begin(), points.end(),
                                    [&](const Eigen::Vector3f& p) { return std::abs(field.at(motion * p)) > limit; });
  return static_cast<double>(broken) / static_cast<double>(std::max<std::size_t>(1, points.size()));
}

Symmetry::Axis settledAxis(const std::vector<Eigen::Vector3f>& points, const DistanceField& field,
                           const Symmetry::Axis& axis, double tolerance)
{
  // Large turns only: an axis is off by more than the surface by the cotangent of half the angle.
  constexpr int FIRST = 60;  // degrees
  constexpr int STEP = 3;
  double least = std::numeric_limits<double>::infinity();
  double best = 0;
  for (int degrees = FIRST; degrees <= 180; degrees += STEP)
  {
    const double angle = degrees * M_PI / 180;
    const double distance = meanDistance(points, field, rotationAbout(axis, angle));
    if (distance < least)
    {
      least = distance;
      best = angle;
    }
  }
  const Symmetry::Axis refined = refinedAxis(points, field, axis, best, tolerance);
  const double before = brokenShare(points, field, rotationAbout(axis, best), tolerance);
  const double after = brokenShare(points, field, rotationAbout(refined, best), tolerance);
  const double gain = least - meanDistance(points, field, rotationAbout(refined, best));
  // Round numbers of a drawing are better than equally good measured ones.
  constexpr double LITTLE = 0.02;  // of the tolerance
  constexpr double FEW = 0.02;     // of the points, which fall to either side of the tolerance
  return after < before + FEW && gain > LITTLE * tolerance ? refined : axis;
}
}  // namespace bin_picking
