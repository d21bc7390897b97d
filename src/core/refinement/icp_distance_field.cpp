// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "../common/simd.hpp"
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

/// Sums over the rows of the normal equations, in the precision of the data: some hundred rows of like size. A row is
/// the derivatives by the six unknowns and the residual; an eighth number fills the vector register.
class RowSums
{
public:
  void add(const FieldRow& row)
  {
    const Eigen::Vector3f turn = row.lever.cross(row.gradient);
    const Eigen::Vector3f& push = row.gradient;
    const float numbers[8] = {turn.x(), turn.y(), turn.z(), push.x(), push.y(), push.z(), row.residual, 0};
    for (int i = 0; i < 7; ++i)
      for (int j = 0; j < 8; ++j)
        products_[i][j] += row.weight * numbers[i] * numbers[j];
    weight_ += row.weight;
    ++count_;
  }

  int count() const { return count_; }
  double rms() const { return std::sqrt(static_cast<double>(products_[6][6] / weight_)); }

  NormalEquations equations() const
  {
    NormalEquations result;
    for (int i = 0; i < 6; ++i)
    {
      for (int j = 0; j < 6; ++j)
        result.A(i, j) = static_cast<double>(products_[i][j]);
      result.b[i] = -static_cast<double>(products_[i][6]);
    }
    return result;
  }

private:
  float products_[7][8] = {};
  float weight_ = 0;
  int count_ = 0;
};

BIN_PICKING_SIMD void addSurface(const FieldRows& rows, const OrientedPoints& measured, RowSums& result)
{
  RowSums sums = result;  // of its own, which no measured point can alias: it stays in registers
  for (std::size_t i = 0; i < measured.size(); ++i)
  {
    const FieldRow row = rows.ofSurface(measured.points[i], measured.normals[i]);
    if (row.weight > 0)
      sums.add(row);
  }
  result = sums;
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
    result.rms = sums.rms();
    addEdges(rows, measured.edges, sums);
    const Vector6d x = solveObservable(sums.equations());
    T_object_camera = movedBy(x, T_object_camera, model);
    result.T_camera_object = T_object_camera.inverse();
    result.converged = gate_is_closed && x.head<3>().norm() + x.tail<3>().norm() < parameters.convergence;
    distance = std::max(distance * shrink, parameters.min_distance * leaf);
  }
  return result;
}
}  // namespace bin_picking
