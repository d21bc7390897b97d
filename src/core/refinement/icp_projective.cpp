// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "bin_picking_perception/refinement/icp.hpp"

namespace bin_picking
{
namespace
{
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Normal equations of the point-to-plane error. Rotations are taken about `pivot` and scaled by `radius`, so that all
/// six unknowns are lengths and their eigenvalues can be compared.
struct NormalEquations
{
  Matrix6d A = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  double squared_error = 0;
  double weight = 0;
  int count = 0;
};

struct Scene
{
  const DepthGrid& grid;
  const std::vector<Eigen::Vector3f>& normals;
  float min_cosine;
};

/// Sums of one row of the normal equations after the other, in the precision of the data: a few hundred rows of like
/// size.
class RowSums
{
public:
  void add(const Eigen::Matrix<float, 6, 1>& row, float residual, float weight)
  {
    for (int i = 0; i < 6; ++i)
    {
      const float weighted = weight * row[i];
      for (int j = 0; j < 6; ++j)
        products_[i][j] += weighted * row[j];
      right_[i] += weighted * residual;
    }
    squared_error_ += weight * residual * residual;
    weight_ += weight;
    ++count_;
  }

  NormalEquations equations() const
  {
    NormalEquations result;
    for (int i = 0; i < 6; ++i)
    {
      for (int j = 0; j < 6; ++j)
        result.A(i, j) = static_cast<double>(products_[i][j]);
      result.b[i] = static_cast<double>(right_[i]);
    }
    result.squared_error = static_cast<double>(squared_error_);
    result.weight = static_cast<double>(weight_);
    result.count = count_;
    return result;
  }

private:
  float products_[6][6] = {};
  float right_[6] = {};
  float squared_error_ = 0;
  float weight_ = 0;
  int count_ = 0;
};

/// The measured pixel at and around the projection of `point` that lies nearest to it in space; -1 if there is none
/// within `gate` with a fitting normal. The nearest of nine: beyond the edge of a face it is the edge, which holds the
/// face in its own plane.
int associate(const Scene& scene, const Eigen::Vector3f& point, const Eigen::Vector3f& normal, float gate)
{
  const PinholeCamera& camera = scene.grid.camera;
  const float inverse_z = 1 / point.z();
  const auto u = static_cast<int>(
      std::lround(static_cast<float>(camera.fx) * point.x() * inverse_z + static_cast<float>(camera.cx)));
  const auto v = static_cast<int>(
      std::lround(static_cast<float>(camera.fy) * point.y() * inverse_z + static_cast<float>(camera.cy)));
  int best = -1;
  float best_distance = gate * gate;
  for (int dv = -1; dv <= 1; ++dv)
    for (int du = -1; du <= 1; ++du)
    {
      if (!scene.grid.inside(u + du, v + dv))
        continue;
      const int i = scene.grid.index(u + du, v + dv);
      const Eigen::Vector3f& n = scene.normals[static_cast<std::size_t>(i)];
      if (!scene.grid.valid(i) || !(n.dot(normal) >= scene.min_cosine))  // NaN: no normal
        continue;
      const float distance = (scene.grid.point(i) - point).squaredNorm();
      if (distance < best_distance)
      {
        best_distance = distance;
        best = i;
      }
    }
  return best;
}

NormalEquations accumulate(const OrientedPoints& model, const std::vector<std::uint32_t>& facing, const Scene& scene,
                           const Pose& T_camera_object, const Eigen::Vector3d& pivot, double radius, double gate)
{
  const Eigen::Isometry3f T = T_camera_object.cast<float>();
  const Eigen::Vector3f origin = pivot.cast<float>();
  const auto inverse_radius = static_cast<float>(1 / radius);
  const auto inverse_gate = static_cast<float>(1 / gate);
  RowSums sums;
  for (const std::uint32_t k : facing)
  {
    const Eigen::Vector3f point = T * model.points[k];
    const Eigen::Vector3f normal = T.linear() * model.normals[k];
    if (point.z() <= 0 || normal.dot(point) >= 0)
      continue;
    const int i = associate(scene, point, normal, static_cast<float>(gate));
    if (i < 0)
      continue;
    const Eigen::Vector3f& n = scene.normals[static_cast<std::size_t>(i)];
    const float residual = n.dot(scene.grid.point(i) - point);
    // Tukey's biweight at the gate: a neighbour's surface just inside it pulls little.
    const float share = residual * inverse_gate;
    const float root = 1 - share * share;
    Eigen::Matrix<float, 6, 1> row;
    const Eigen::Vector3f lever = (point - origin) * inverse_radius;
    row << lever.y() * n.z() - lever.z() * n.y(), lever.z() * n.x() - lever.x() * n.z(),
        lever.x() * n.y() - lever.y() * n.x(), n;
    sums.add(row, residual, root * root);
  }
  return sums.equations();
}

/// Solves in the directions that the surface holds; where its eigenvalue is tiny (along a cylinder) nothing moves.
Vector6d solveObservable(const NormalEquations& equations)
{
  constexpr double MIN_EIGENVALUE_SHARE = 2e-3;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(equations.A);
  const Vector6d& values = solver.eigenvalues();
  Vector6d x = Vector6d::Zero();
  for (int i = 0; i < 6; ++i)
    if (values[i] > MIN_EIGENVALUE_SHARE * values[5])
      x += solver.eigenvectors().col(i) * (solver.eigenvectors().col(i).dot(equations.b) / values[i]);
  return x;
}

Pose applyStep(const Pose& T_camera_object, const Vector6d& x, const Eigen::Vector3d& pivot, double radius)
{
  const Eigen::Vector3d rotation = x.head<3>() / radius;
  const double angle = rotation.norm();
  Pose step = Pose::Identity();
  if (angle > 0)
    step.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  step.translation() = pivot - step.linear() * pivot + x.tail<3>();
  Pose T = step * T_camera_object;
  // Products of rotations drift; the nearest rotation keeps the pose rigid.
  T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  return T;
}
}  // namespace

IcpResult icpProjective(const OrientedPoints& model, const std::vector<std::uint32_t>& facing, const DepthGrid& grid,
                        const std::vector<Eigen::Vector3f>& normals, const Pose& initial, double leaf,
                        const IcpParameters& parameters)
{
  constexpr int MIN_PAIRS = 12;
  IcpResult result;
  result.T_camera_object = initial;
  result.rms = std::numeric_limits<double>::quiet_NaN();
  if (facing.empty())
    return result;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const std::uint32_t i : facing)
    center += model.points[i].cast<double>() / static_cast<double>(facing.size());
  const double radius = boundingBoxDiagonal(model.points) / 2;
  const Scene scene{grid, normals, static_cast<float>(std::cos(parameters.max_normal_angle))};

  // Half of the iterations close the gate.
  const double shrink = std::pow(parameters.min_distance / parameters.max_distance, 2.0 / parameters.max_iterations);
  double gate = parameters.max_distance * leaf;
  for (; result.iterations < parameters.max_iterations && !result.converged; ++result.iterations)
  {
    const bool gate_is_closed = gate <= parameters.min_distance * leaf * 1.001;
    const Eigen::Vector3d pivot = result.T_camera_object * center;
    const NormalEquations equations = accumulate(model, facing, scene, result.T_camera_object, pivot, radius, gate);
    result.correspondences = equations.count;
    if (equations.count < MIN_PAIRS)
      break;
    result.rms = std::sqrt(equations.squared_error / equations.weight);
    const Vector6d x = solveObservable(equations);
    result.T_camera_object = applyStep(result.T_camera_object, x, pivot, radius);
    result.converged = gate_is_closed && x.head<3>().norm() + x.tail<3>().norm() < parameters.convergence;
    gate = std::max(gate * shrink, parameters.min_distance * leaf);
  }
  return result;
}
}  // namespace bin_picking
