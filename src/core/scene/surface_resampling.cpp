// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/scene/surface_resampling.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "bin_picking_perception/common/parallel.hpp"
#include "tiled_points.hpp"
#include "voxel_order.hpp"

namespace bin_picking
{
namespace
{
constexpr float SPLIT_COSINE = 0.866f;  // 30 degrees
constexpr std::size_t MAX_POINTS_PER_VOXEL = 3;
constexpr std::size_t BUNDLE = 64;
constexpr double MIN_PLANE_POINTS = 5;

struct Group
{
  Eigen::Vector3f point = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  float count = 0;
};

/// Adds a point to the first group whose mean normal is near; opens a new one if none is and there is room.
void addToGroups(std::vector<Group>& groups, const Eigen::Vector3f& point, const Eigen::Vector3f& normal)
{
  for (auto& group : groups)
    if (group.normal.dot(normal) > SPLIT_COSINE * group.normal.norm())
    {
      group.point += point;
      group.normal += normal;
      group.count += 1;
      return;
    }
  if (groups.size() < MAX_POINTS_PER_VOXEL)
    groups.push_back({point, normal, 1});
}
}  // namespace

OrientedPoints voxelDownsample(const OrientedPoints& dense, double leaf, int min_points)
{
  const std::vector<VoxelMember> order = voxelOrder(dense.points, leaf);
  OrientedPoints result;
  std::vector<Group> groups;
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    const std::size_t k = order[i].point;
    addToGroups(groups, dense.points[k], dense.normals[k]);
    if (i + 1 < order.size() && order[i].voxel == order[i + 1].voxel)
      continue;
    for (const auto& group : groups)
    {
      if (group.count < static_cast<float>(min_points))
        continue;
      result.points.push_back(group.point / group.count);
      result.normals.push_back(group.normal.normalized());
    }
    groups.clear();
  }
  return result;
}

namespace
{
Eigen::Vector3f planeNormal(const PlaneMoments& moments, const Eigen::Vector3f& given)
{
  if (moments.count < MIN_PLANE_POINTS)
    return given;
  const Eigen::Vector3d mean = moments.sum / moments.count;
  const Eigen::Matrix3d covariance = moments.products / moments.count - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);  // in closed form: thousands of planes
  const Eigen::Vector3f normal = solver.eigenvectors().col(0).cast<float>().normalized();
  return normal.dot(given) < 0 ? Eigen::Vector3f(-normal) : normal;
}
}  // namespace

std::vector<Eigen::Vector3f> estimateNormals(const OrientedPoints& queries, const OrientedPoints& support,
                                             double radius, double max_normal_angle, const Executor& executor)
{
  const TiledPoints tiled(support, static_cast<float>(radius));
  const auto min_cosine = static_cast<float>(std::cos(max_normal_angle));
  std::vector<Eigen::Vector3f> normals(queries.size());
  executor.forEachBundle(queries.size(), BUNDLE, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      normals[i] =
          planeNormal(tiled.planeMoments(queries.points[i], queries.normals[i], min_cosine), queries.normals[i]);
  });
  return normals;
}

OrientedPoints resamplePoints(const OrientedPoints& dense, double leaf, double normal_radius, const Executor& executor)
{
  constexpr double SAME_FACE_ANGLE = 1.05;  // 60 degrees: a plane is not fitted around an edge
  OrientedPoints points = voxelDownsample(dense, leaf);
  points.normals = estimateNormals(points, dense, normal_radius, SAME_FACE_ANGLE, executor);
  return points;
}

std::vector<float> allRoundCurvature(const OrientedPoints& points, const OrientedPoints& dense,
                                     CurvatureMeasure measure, double radius, const Executor& executor)
{
  constexpr int MIN_NEIGHBOURS = 8;
  constexpr double SPACING = 0.125;  // of the radius: some 200 neighbours, as a fit to a grid sees; more tell no more
  const OrientedPoints support = voxelDownsample(dense, SPACING * radius);
  return estimateCurvature(points, support, measure, radius, OPPOSITE_WALL_ANGLE, MIN_NEIGHBOURS, executor);
}

OrientedPoints resampleSurface(const OrientedPoints& dense, const SurfaceResampling& resampling,
                               const Executor& executor)
{
  OrientedPoints points = resamplePoints(dense, resampling.leaf, resampling.normal_radius, executor);
  points.curvature = allRoundCurvature(points, dense, resampling.measure, resampling.curvature_radius, executor);
  return points;
}
}  // namespace bin_picking
