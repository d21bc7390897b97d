// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/scene/surface_resampling.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <tuple>

#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/common/parallel.hpp"

namespace bin_picking
{
namespace
{
constexpr float SPLIT_COSINE = 0.866f;  // 30 degrees
constexpr std::size_t MAX_POINTS_PER_VOXEL = 3;
constexpr std::size_t BLOCK = 256;
constexpr std::size_t MIN_PLANE_POINTS = 5;

struct Voxel
{
  std::int32_t x, y, z;
  int index;
  bool operator<(const Voxel& other) const
  {
    return std::tie(z, y, x, index) < std::tie(other.z, other.y, other.x, other.index);
  }
  bool sameCell(const Voxel& other) const { return x == other.x && y == other.y && z == other.z; }
};

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
  std::vector<Voxel> voxels(dense.size());
  const auto scale = static_cast<float>(1.0 / leaf);
  for (std::size_t i = 0; i < dense.size(); ++i)
  {
    const Eigen::Vector3f cell = dense.points[i] * scale;
    voxels[i] = {static_cast<std::int32_t>(std::floor(cell.x())), static_cast<std::int32_t>(std::floor(cell.y())),
                 static_cast<std::int32_t>(std::floor(cell.z())), static_cast<int>(i)};
  }
  std::sort(voxels.begin(), voxels.end());

  OrientedPoints result;
  std::vector<Group> groups;
  for (std::size_t i = 0; i < voxels.size(); ++i)
  {
    const auto k = static_cast<std::size_t>(voxels[i].index);
    addToGroups(groups, dense.points[k], dense.normals[k]);
    if (i + 1 < voxels.size() && voxels[i].sameCell(voxels[i + 1]))
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
Eigen::Vector3f planeNormal(const Eigen::Vector3f& point, const Eigen::Vector3f& given, const OrientedPoints& support,
                            const std::vector<int>& neighbours, float min_cosine)
{
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  Eigen::Matrix3f moments = Eigen::Matrix3f::Zero();
  std::size_t count = 0;
  for (const int n : neighbours)
  {
    const auto k = static_cast<std::size_t>(n);
    if (support.normals[k].dot(given) < min_cosine)
      continue;
    const Eigen::Vector3f d = support.points[k] - point;
    mean += d;
    moments += d * d.transpose();
    ++count;
  }
  if (count < MIN_PLANE_POINTS)
    return given;
  mean /= static_cast<float>(count);
  const Eigen::Matrix3f covariance = moments / static_cast<float>(count) - mean * mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance.cast<double>());
  const Eigen::Vector3f normal = solver.eigenvectors().col(0).cast<float>().normalized();
  return normal.dot(given) < 0 ? Eigen::Vector3f(-normal) : normal;
}
}  // namespace

std::vector<Eigen::Vector3f> estimateNormals(const OrientedPoints& queries, const OrientedPoints& support,
                                             double radius, double max_normal_angle, const Executor& executor)
{
  const KdTree tree(support.points);
  const auto min_cosine = static_cast<float>(std::cos(max_normal_angle));
  std::vector<Eigen::Vector3f> normals(queries.size());
  executor.forEach((queries.size() + BLOCK - 1) / BLOCK, [&](std::size_t block) {
    std::vector<int> neighbours;
    for (std::size_t i = block * BLOCK; i < std::min(queries.size(), (block + 1) * BLOCK); ++i)
    {
      tree.radiusSearch(queries.points[i], static_cast<float>(radius), neighbours);
      normals[i] = planeNormal(queries.points[i], queries.normals[i], support, neighbours, min_cosine);
    }
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
