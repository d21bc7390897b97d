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

/// The measured pixel at and around the projection of `point` that lies nearest to it in space; -1 if there is none
/// within `gate` with a fitting normal.
int associate(const Scene& scene, const Eigen::Vector3f& point, const Eigen::Vector3f& normal, float gate)
{
  const PinholeCamera& camera = scene.grid.camera;
  const auto u = static_cast<int>(std::lround(camera.fx * static_cast<double>(point.x() / point.z()) + camera.cx));
  const auto v = static_cast<int>(std::lround(camera.fy * static_cast<double>(point.y() / point.z()) + camera.cy));
  int best = -1;
  float best_distance = gate * gate;
  for (int dv = -1; dv <= 1; ++dv)
    for (int du = -1; du <= 1; ++du)
    {
      if (!scene.grid.inside(u + du, v + dv))
        continue;
      const int i = scene.grid.index(u + du, v + dv);
      const Eigen::Vector3f& n = scene.normals[static_cast<std::size_t>(i)];
      if (!scene.grid.valid(i) || std::isnan(n.x()) || n.dot(normal) < scene.min_cosine)
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

NormalEquations accumulate(const OrientedPoints& model, const Scene& scene, const Pose& T_camera_object,
                           const Eigen::Vector3d& pivot, double radius, double gate)
{
  const Eigen::Isometry3f T = T_camera_object.cast<float>();
  NormalEquations equations;
  for (std::size_t k = 0; k < model.size(); ++k)
  {
    const Eigen::Vector3f point = T * model.points[k];
    const Eigen::Vector3f normal = T.linear() * model.normals[k];
    if (point.z() <= 0 || normal.dot(point) >= 0)
      continue;
    const int i = associate(scene, point, normal, static_cast<float>(gate));
    if (i < 0)
      continue;
    const Eigen::Vector3d n = scene.normals[static_cast<std::size_t>(i)].cast<double>();
    const double residual = n.dot((scene.grid.point(i) - point).cast<double>());
    // Tukey's biweight at the gate: a neighbour's surface just inside it pulls little.
    const double share = residual / gate;
    const double weight = std::pow(1 - std::min(1.0, share * share), 2);
    Vector6d row;
    row << (point.cast<double>() - pivot).cross(n) / radius, n;
    equations.A.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
    equations.b += weight * residual * row;
    equations.squared_error += weight * residual * residual;
    equations.weight += weight;
    ++equations.count;
  }
  return equations;
}

/// Solves in the directions that the surface holds; where its eigenvalue is tiny (along a cylinder) nothing moves.
Vector6d solveObservable(const NormalEquations& equations)
{
  constexpr double MIN_EIGENVALUE_SHARE = 2e-3;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(Matrix6d(equations.A.selfadjointView<Eigen::Lower>()));
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

IcpResult icpProjective(const OrientedPoints& model_points, const DepthGrid& grid,
                        const std::vector<Eigen::Vector3f>& normals, const Pose& initial, double leaf,
                        const IcpParameters& parameters)
{
  constexpr int MIN_PAIRS = 12;
  IcpResult result;
  result.T_camera_object = initial;
  result.rms = std::numeric_limits<double>::quiet_NaN();
  if (model_points.empty())
    return result;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const auto& point : model_points.points)
    center += point.cast<double>() / static_cast<double>(model_points.size());
  const double radius = boundingBoxDiagonal(model_points.points) / 2;
  const Scene scene{grid, normals, static_cast<float>(std::cos(parameters.max_normal_angle))};

  const double shrink = std::pow(parameters.min_distance / parameters.max_distance, 2.0 / parameters.max_iterations);
  double gate = parameters.max_distance * leaf;
  for (; result.iterations < parameters.max_iterations && !result.converged; ++result.iterations)
  {
    const Eigen::Vector3d pivot = result.T_camera_object * center;
    const NormalEquations equations = accumulate(model_points, scene, result.T_camera_object, pivot, radius, gate);
    result.correspondences = equations.count;
    if (equations.count < MIN_PAIRS)
      break;
    result.rms = std::sqrt(equations.squared_error / equations.weight);
    const Vector6d x = solveObservable(equations);
    result.T_camera_object = applyStep(result.T_camera_object, x, pivot, radius);
    const bool gate_is_closed = gate <= parameters.min_distance * leaf * 1.001;
    result.converged = gate_is_closed && x.head<3>().norm() + x.tail<3>().norm() < parameters.convergence;
    gate = std::max(gate * shrink, parameters.min_distance * leaf);
  }
  return result;
}
}  // namespace bin_picking
