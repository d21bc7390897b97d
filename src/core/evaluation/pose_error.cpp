// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/pose_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/kd_tree.hpp"

namespace bin_picking
{
namespace
{
void requirePoints(const std::vector<Eigen::Vector3f>& points)
{
  if (points.empty())
    throw ParameterError("A pose error over no points has no value; pass the vertices or surface points of the part.");
}

/// Largest squared distance of a point from where T puts it.
double largestSquaredMotion(const std::vector<Eigen::Vector3f>& points, const Pose& T)
{
  double largest = 0;
  for (const Eigen::Vector3f& point : points)
  {
    const Eigen::Vector3d p = point.cast<double>();
    largest = std::max(largest, (T * p - p).squaredNorm());
  }
  return largest;
}
}  // namespace

PoseError poseError(const Pose& estimate, const Pose& truth, const Symmetry& symmetry, const Eigen::Vector3d& center)
{
  const Pose equivalent = nearestEquivalent(estimate, truth, symmetry);
  // Unlike acos of the trace, the quaternion's half angle by atan2 is exact for small errors.
  const Eigen::Quaterniond difference(Eigen::Matrix3d(truth.linear().transpose() * equivalent.linear()));
  PoseError error;
  error.translation = (equivalent * center - truth * center).norm();
  error.rotation = 2 * std::atan2(difference.vec().norm(), std::abs(difference.w()));
  return error;
}

double averageDistance(const std::vector<Eigen::Vector3f>& points, const Pose& estimate, const Pose& truth)
{
  requirePoints(points);
  const Pose T_truth_estimate = truth.inverse() * estimate;
  double sum = 0;
  for (const Eigen::Vector3f& point : points)
  {
    const Eigen::Vector3d p = point.cast<double>();
    sum += (T_truth_estimate * p - p).norm();
  }
  return sum / static_cast<double>(points.size());
}

double averageNearestDistance(const std::vector<Eigen::Vector3f>& points, const Pose& estimate, const Pose& truth)
{
  requirePoints(points);
  const KdTree tree(points);
  // Distances do not change with the frame: the true points are moved into the frame of the estimate, where the tree
  // is.
  const Pose T_estimate_truth = estimate.inverse() * truth;
  double sum = 0;
  for (const Eigen::Vector3f& point : points)
  {
    const Eigen::Vector3f query = (T_estimate_truth * point.cast<double>()).cast<float>();
    sum += std::sqrt(static_cast<double>(tree.nearest(query, std::numeric_limits<float>::infinity()).squared_distance));
  }
  return sum / static_cast<double>(points.size());
}

namespace
{
/// \param nearest variant of the estimate that is nearest to the truth in rotation: it joins the samples of an axis, so
/// that a perfect pose has no error at all
double smallestDistance(const std::vector<Eigen::Vector3f>& points, const Pose& estimate, const Pose& truth,
                        const Pose& nearest, const std::vector<Pose>& variants)
{
  const Pose T_truth_estimate = truth.inverse() * estimate;
  double smallest = largestSquaredMotion(points, truth.inverse() * nearest);
  for (const Pose& T_object_variant : variants)
    smallest = std::min(smallest, largestSquaredMotion(points, T_truth_estimate * T_object_variant));
  return std::sqrt(smallest);
}

void requireSteps(int steps)
{
  if (steps < 1)
    throw ParameterError("A continuous symmetry was to be sampled at " + std::to_string(steps) +
                         " angles; at least 1 is needed, 360 is usual.");
}
}  // namespace

double maximumSymmetryAwareDistance(const std::vector<Eigen::Vector3f>& points, const Pose& estimate, const Pose& truth,
                                    const Symmetry& symmetry, int steps)
{
  requirePoints(points);
  requireSteps(steps);
  return smallestDistance(points, estimate, truth, nearestEquivalent(estimate, truth, symmetry),
                          symmetry.sampled(steps));
}

double maximumSymmetryAwareDistance(const std::vector<Eigen::Vector3f>& points, const Pose& estimate, const Pose& truth,
                                    const Symmetry& symmetry, const UndeterminedTurn& turn, int steps)
{
  requirePoints(points);
  requireSteps(steps);
  return smallestDistance(points, estimate, truth, nearestTurned(estimate, truth, turn, symmetry),
                          sampledTurns(turn, symmetry, steps));
}
}  // namespace bin_picking
