// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/scene/curvature.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/common/parallel.hpp"

namespace bin_picking
{
SurfaceCurvature quadricCurvature(double a, double b, double c, double d, double e)
{
  // r(x, y) = (x, y, z(x, y)): r_x = (1, 0, z_x), r_y = (0, 1, z_y); at the origin z_x = d, z_y = e.
  const double E = 1 + d * d;
  const double F = d * e;
  const double G = 1 + e * e;
  const double norm = std::sqrt(1 + d * d + e * e);  // |r_x x r_y|
  // The frame's z axis is the outward normal, so a convex surface bends away from it: the sign is turned to make it >
  // 0.
  const double L = -2 * a / norm;
  const double M = -b / norm;
  const double N = -2 * c / norm;
  const double det = E * G - F * F;

  SurfaceCurvature curvature;
  curvature.gaussian = (L * N - M * M) / det;                // Equation 3
  curvature.mean = (L * G - 2 * M * F + N * E) / (2 * det);  // Equation 4
  const double root = std::sqrt(std::max(0.0, curvature.mean * curvature.mean - curvature.gaussian));
  curvature.k1 = curvature.mean + root;  // roots of Equation 2
  curvature.k2 = curvature.mean - root;
  return curvature;
}

namespace
{
constexpr std::size_t BLOCK = 128;

/// Axes of the tangent plane of a unit normal, as rows of a rotation whose third row is the normal.
Eigen::Matrix3f tangentFrame(const Eigen::Vector3f& normal)
{
  const Eigen::Vector3f helper = std::abs(normal.x()) < 0.6f ? Eigen::Vector3f::UnitX() : Eigen::Vector3f::UnitY();
  Eigen::Matrix3f frame;
  frame.row(0) = normal.cross(helper).normalized();
  frame.row(1) = normal.cross(frame.row(0).transpose());
  frame.row(2) = normal;
  return frame;
}

float meanCurvature(const Eigen::Vector3f& point, const Eigen::Matrix3f& frame, const OrientedPoints& support,
                    const std::vector<int>& neighbours, float radius)
{
  Eigen::Matrix<double, 6, 6> normal_matrix = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  for (const int n : neighbours)
  {
    // In units of the radius, so that the normal equations are well scaled.
    const Eigen::Vector3d q = (frame * (support.points[static_cast<std::size_t>(n)] - point) / radius).cast<double>();
    Eigen::Matrix<double, 6, 1> row;
    row << q.x() * q.x(), q.x() * q.y(), q.y() * q.y(), q.x(), q.y(), 1;
    normal_matrix.selfadjointView<Eigen::Lower>().rankUpdate(row);
    right += row * q.z();
  }
  const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(normal_matrix.selfadjointView<Eigen::Lower>());
  const Eigen::Matrix<double, 6, 1> s = solver.solve(right);
  if (!s.allFinite() || solver.vectorD().minCoeff() < 1e-9 * solver.vectorD().maxCoeff())
    return std::numeric_limits<float>::quiet_NaN();
  return static_cast<float>(quadricCurvature(s[0], s[1], s[2], s[3], s[4]).mean / static_cast<double>(radius));
}

float normalVariation(const Eigen::Matrix3f& frame, const OrientedPoints& support, const std::vector<int>& neighbours)
{
  Eigen::Vector2f mean = Eigen::Vector2f::Zero();
  Eigen::Vector2f squares = Eigen::Vector2f::Zero();
  for (const int n : neighbours)
  {
    const Eigen::Vector2f projected = frame.topRows<2>() * support.normals[static_cast<std::size_t>(n)];
    mean += projected;
    squares += projected.cwiseProduct(projected);
  }
  const auto count = static_cast<float>(neighbours.size());
  // pc1 + pc2 is the trace of the covariance of the projected normals.
  return (squares / count - (mean / count).cwiseAbs2()).sum() / 2;
}
}  // namespace

std::vector<float> estimateCurvature(const OrientedPoints& queries, const OrientedPoints& support,
                                     CurvatureMeasure measure, double radius, double max_normal_angle,
                                     int min_neighbours, const Executor& executor)
{
  const KdTree tree(support.points);
  const auto min_cosine = static_cast<float>(std::cos(max_normal_angle));
  const auto r = static_cast<float>(radius);
  std::vector<float> curvature(queries.size(), std::numeric_limits<float>::quiet_NaN());
  executor.forEach((queries.size() + BLOCK - 1) / BLOCK, [&](std::size_t block) {
    std::vector<int> neighbours;
    for (std::size_t i = block * BLOCK; i < std::min(queries.size(), (block + 1) * BLOCK); ++i)
    {
      tree.radiusSearch(queries.points[i], r, neighbours);
      neighbours.erase(
          std::remove_if(
              neighbours.begin(), neighbours.end(),
              [&](int n) { return support.normals[static_cast<std::size_t>(n)].dot(queries.normals[i]) < min_cosine; }),
          neighbours.end());
      if (static_cast<int>(neighbours.size()) < min_neighbours)
        continue;
      const Eigen::Matrix3f frame = tangentFrame(queries.normals[i]);
      curvature[i] = measure == CurvatureMeasure::MeanCurvature
                         ? meanCurvature(queries.points[i], frame, support, neighbours, r)
                         : normalVariation(frame, support, neighbours);
    }
  });
  return curvature;
}
}  // namespace bin_picking
