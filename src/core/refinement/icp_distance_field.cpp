// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "field_rows.hpp"

namespace bin_picking
{
namespace
{
/// A x = b.
struct NormalEquations
{
  Matrix6d A;
  Vector6d b;
};

NormalEquations equations(const RowSums& sums)
{
  NormalEquations result;
  for (std::size_t i = 0; i < 6; ++i)
  {
    for (std::size_t j = 0; j < 6; ++j)
      result.A(static_cast<int>(i), static_cast<int>(j)) = sums.product(std::min(i, j), std::max(i, j));
    result.b[static_cast<int>(i)] = -sums.product(i, 6);
  }
  return result;
}

void addSurface(const FieldRows& rows, const OrientedPoints& measured, RowSums& sums)
{
  FieldRowBlock block;
  for (std::size_t first = 0; first < measured.size(); first += FieldRowBlock::SIZE)
  {
    rows.ofSurface(measured, first, block);
    sums.add(block);
  }
}

void addEdges(const FieldRows& rows, const OrientedPoints& edges, RowSums& sums)
{
  for (std::size_t i = 0; i < edges.size(); ++i)
  {
    const FieldRow row = rows.ofEdge(edges.points[i], edges.normals[i]);
    if (row.weight > 0)
      sums.add(row);
  }
}

/// Solves in the directions that the surface holds; where its eigenvalue is tiny (along a cylinder) nothing moves.
Vector6d solveObservable(const NormalEquations& equations)
{
  constexpr double MIN_EIGENVALUE_SHARE = 5e-4;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(equations.A);
  const Vector6d& values = solver.eigenvalues();
  Vector6d x = Vector6d::Zero();
  for (int i = 0; i < 6; ++i)
    if (values[i] > MIN_EIGENVALUE_SHARE * values[5])
      x += solver.eigenvectors().col(i) * (solver.eigenvectors().col(i).dot(equations.b) / values[i]);
  return x;
}
}  // namespace

IcpResult icpDistanceField(const TrainedModel& model, const MeasuredPart& measured, const Pose& initial,
                           const IcpParameters& parameters)
{
  constexpr int MIN_PAIRS = 12;
  const double leaf = model.parameters.leaf;
  IcpResult result;
  result.T_camera_object = initial;
  result.rms = std::numeric_limits<double>::quiet_NaN();
  Pose T_object_camera = initial.inverse();
  // Half of the iterations close the gate.
  const double shrink = std::pow(parameters.min_distance / parameters.max_distance, 2.0 / parameters.max_iterations);
  double distance = parameters.max_distance * leaf;
  for (; result.iterations < parameters.max_iterations && !result.converged; ++result.iterations)
  {
    const bool gate_is_closed = distance <= parameters.min_distance * leaf * 1.001;
    const FieldRows rows(model, T_object_camera, distance, parameters.max_normal_angle);
    RowSums sums;
    addSurface(rows, measured.surface, sums);
    result.correspondences = sums.count();
    if (result.correspondences < MIN_PAIRS)
      break;
    result.rms = std::sqrt(sums.product(6, 6) / sums.weight());
    addEdges(rows, measured.edges, sums);
    const Vector6d x = solveObservable(equations(sums));
    T_object_camera = movedBy(x, T_object_camera, model);
    result.T_camera_object = T_object_camera.inverse();
    result.converged = gate_is_closed && x.head<3>().norm() + x.tail<3>().norm() < parameters.convergence;
    distance = std::max(distance * shrink, parameters.min_distance * leaf);
  }
  return result;
}
}  // namespace bin_picking
