// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "../common/simd.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "bin_picking_perception/refinement/icp.hpp"

namespace bin_picking
{
namespace
{
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A x = b. Rotations are taken about the part's middle and scaled by its radius, so that all six unknowns are lengths
/// and their eigenvalues can be compared.
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
  void add(const Eigen::Vector3f& lever, const Eigen::Vector3f& gradient, float residual, float weight)
  {
    const Eigen::Vector3f turn = lever.cross(gradient);
    const float row[8] = {turn.x(), turn.y(), turn.z(), gradient.x(), gradient.y(), gradient.z(), residual, 0};
    for (int i = 0; i < 7; ++i)
      for (int j = 0; j < 8; ++j)
        products_[i][j] += weight * row[i] * row[j];
    weight_ += weight;
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

struct Gate
{
  float distance;    ///< metres
  float min_cosine;  ///< between measured normal and gradient
  float step;        ///< from an edge outward, metres
};

/// Tukey's biweight at the gate: a neighbour's surface just inside it pulls little. 0 outside.
float biweight(float residual, float gate)
{
  const float share = residual / gate;
  const float root = std::max(0.0f, 1 - share * share);
  return root * root;
}

/// One row per measured point: its distance from the part's surface. In the part's frame, so that the field is read
/// without turning its gradient back.
BIN_PICKING_SIMD void addSurface(const DistanceField& field, const OrientedPoints& measured,
                                 const Eigen::Isometry3f& T_object_camera, const Eigen::Vector3f& pivot,
                                 float inverse_radius, const Gate& gate, RowSums& result)
{
  RowSums sums = result;  // of its own, which no measured point can alias: it stays in registers
  for (std::size_t i = 0; i < measured.size(); ++i)
  {
    const Eigen::Vector3f p = T_object_camera * measured.points[i];
    const DistanceField::Sample sample = field.sample(p);
    const float weight = biweight(sample.distance, gate.distance);
    if (weight <= 0)
      continue;
    const Eigen::Vector3f normal = T_object_camera.linear() * measured.normals[i];
    if (normal.dot(sample.gradient) > gate.min_cosine * sample.gradient.norm())
      sums.add((p - pivot) * inverse_radius, sample.gradient, sample.distance, weight);
  }
  result = sums;
}

/// One row per measured edge: a step outside of it the distance is the step.
void addEdges(const DistanceField& field, const OrientedPoints& edges, const Eigen::Isometry3f& T_object_camera,
              const Eigen::Vector3f& pivot, float inverse_radius, const Gate& gate, RowSums& sums)
{
  // An edge is known to about half a pixel of the working grid, a sixth of a leaf, and a surface several times better;
  // but the errors of neighbouring pixels are alike, so that many say no more than one.
  constexpr float WEIGHT = 0.3f;
  constexpr float MIN_COSINE = 0.7f;  // beside a concave corner of the outline another side of the part is nearer
  for (std::size_t i = 0; i < edges.size(); ++i)
  {
    const Eigen::Vector3f outward = T_object_camera.linear() * edges.normals[i];
    const Eigen::Vector3f p = T_object_camera * edges.points[i] + gate.step * outward;
    const DistanceField::Sample sample = field.sample(p);
    const float residual = sample.distance - gate.step;
    const float weight = WEIGHT * biweight(residual, gate.step);
    if (weight > 0 && outward.dot(sample.gradient) > MIN_COSINE * sample.gradient.norm())
      sums.add((p - pivot) * inverse_radius, sample.gradient, residual, weight);
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

Pose applyStep(const Pose& T_object_camera, const Vector6d& x, const Eigen::Vector3d& pivot, double radius)
{
  const Eigen::Vector3d rotation = x.head<3>() / radius;
  const double angle = rotation.norm();
  Pose step = Pose::Identity();
  if (angle > 0)
    step.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  step.translation() = pivot - step.linear() * pivot + x.tail<3>();
  Pose T = step * T_object_camera;
  // Products of rotations drift; the nearest rotation keeps the pose rigid.
  T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  return T;
}
}  // namespace

IcpResult icpDistanceField(const TrainedModel& model, const MeasuredPart& measured, const Pose& initial,
                           const IcpParameters& parameters)
{
  constexpr int MIN_PAIRS = 12;
  constexpr float EDGE_STEP = 0.75f;  // of the leaf: half of the field's band
  const double leaf = model.parameters.leaf;
  const double radius = model.size.norm() / 2;
  const Eigen::Vector3f pivot = model.center.cast<float>();
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
    const Gate gate{static_cast<float>(distance), static_cast<float>(std::cos(parameters.max_normal_angle)),
                    EDGE_STEP * static_cast<float>(leaf)};
    const Eigen::Isometry3f T = T_object_camera.cast<float>();
    RowSums sums;
    addSurface(model.field, measured.surface, T, pivot, static_cast<float>(1 / radius), gate, sums);
    result.correspondences = sums.count();
    if (result.correspondences < MIN_PAIRS)
      break;
    result.rms = sums.rms();
    addEdges(model.field, measured.edges, T, pivot, static_cast<float>(1 / radius), gate, sums);
    const Vector6d x = solveObservable(sums.equations());
    T_object_camera = applyStep(T_object_camera, x, model.center, radius);
    result.T_camera_object = T_object_camera.inverse();
    result.converged = gate_is_closed && x.head<3>().norm() + x.tail<3>().norm() < parameters.convergence;
    distance = std::max(distance * shrink, parameters.min_distance * leaf);
  }
  return result;
}
}  // namespace bin_picking
