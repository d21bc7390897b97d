// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>
#include <limits>

#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/refinement/icp.hpp"

namespace bin_picking
{
namespace
{
struct Correspondences
{
  std::vector<Eigen::Vector3d> object;  ///< model points, part frame
  std::vector<Eigen::Vector3d> camera;  ///< scene points
  double squared_error = 0;
};

/// Where a point has to be to have a correspondence: most of a bin is elsewhere. With room for what rounding moves.
Eigen::AlignedBox3f boxAround(const std::vector<Eigen::Vector3f>& model, double max_distance)
{
  Eigen::AlignedBox3f box;
  for (const auto& point : model)
    box.extend(point);
  const Eigen::Vector3f around = Eigen::Vector3f::Constant(1.001f * static_cast<float>(max_distance));
  return {box.min() - around, box.max() + around};
}

Correspondences findCorrespondences(const KdTree& model, const Eigen::AlignedBox3f& around_model,
                                    const OrientedPoints& scene, const Pose& T_camera_object, double max_distance)
{
  const Eigen::Isometry3f T_object_camera = T_camera_object.inverse().cast<float>();
  Correspondences pairs;
  for (const auto& point : scene.points)
  {
    const Eigen::Vector3f point_object = T_object_camera * point;
    if (!around_model.contains(point_object))
      continue;
    const auto nearest = model.nearest(point_object, static_cast<float>(max_distance));
    if (nearest.index < 0)
      continue;
    pairs.object.push_back(model.points()[static_cast<std::size_t>(nearest.index)].cast<double>());
    pairs.camera.push_back(point.cast<double>());
    pairs.squared_error += static_cast<double>(nearest.squared_distance);
  }
  return pairs;
}

/// Rigid motion of least squares between paired points (Arun et al. 1987); a rotation also where they lie in a plane.
Pose alignPairs(const Correspondences& pairs)
{
  const auto count = static_cast<double>(pairs.object.size());
  Eigen::Vector3d mean_object = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_camera = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < pairs.object.size(); ++i)
  {
    mean_object += pairs.object[i];
    mean_camera += pairs.camera[i];
  }
  mean_object /= count;
  mean_camera /= count;
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < pairs.object.size(); ++i)
    cross += (pairs.camera[i] - mean_camera) * (pairs.object[i] - mean_object).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  signs.z() = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
  Pose T = Pose::Identity();
  T.linear() = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  T.translation() = mean_camera - T.linear() * mean_object;
  return T;
}

/// Largest motion of the correspondences between two poses.
double motion(const Correspondences& pairs, const Pose& before, const Pose& after)
{
  double largest = 0;
  for (const auto& point : pairs.object)
    largest = std::max(largest, (before * point - after * point).norm());
  return largest;
}
}  // namespace

IcpResult icpPointToPoint(const KdTree& model, const OrientedPoints& scene, const Pose& initial, double max_distance,
                          const IcpParameters& parameters)
{
  constexpr std::size_t MIN_PAIRS = 6;
  const Eigen::AlignedBox3f around = boxAround(model.points(), max_distance);
  IcpResult result;
  result.T_camera_object = initial;
  Correspondences pairs = findCorrespondences(model, around, scene, initial, max_distance);
  while (result.iterations < parameters.max_iterations && pairs.object.size() >= MIN_PAIRS && !result.converged)
  {
    const Pose next = alignPairs(pairs);
    result.converged = motion(pairs, result.T_camera_object, next) < parameters.convergence;
    result.T_camera_object = next;
    ++result.iterations;
    pairs = findCorrespondences(model, around, scene, next, max_distance);
  }
  result.correspondences = static_cast<int>(pairs.object.size());
  result.rms = pairs.object.empty() ? std::numeric_limits<double>::quiet_NaN()
                                    : std::sqrt(pairs.squared_error / static_cast<double>(pairs.object.size()));
  return result;
}
}  // namespace bin_picking
