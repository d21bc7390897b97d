// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "bin_picking_perception/model/trained_model.hpp"
#include "bin_picking_perception/refinement/icp.hpp"

/// What a measured point says about a pose, as a row of the linearised problem. Rotations are taken about the part's
/// middle and scaled by its radius, so that all six unknowns are lengths and can be compared.
namespace bin_picking
{
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

struct FieldRow
{
  Eigen::Vector3f lever;     ///< from the part's middle, in radii
  Eigen::Vector3f gradient;  ///< of the distance
  float residual = 0;        ///< metres
  float weight = 0;          ///< 0: says nothing
};

/// Many rows at once: of each its derivatives by rotation and translation, and the residual.
struct FieldRowBlock
{
  static constexpr std::size_t SIZE = DistanceField::BLOCK;
  static constexpr std::size_t COLUMNS = 7;

  std::array<DistanceField::Numbers, COLUMNS> columns;
  DistanceField::Numbers weight;  ///< 0: says nothing
};

/// Makes the rows of a pose. In the part's frame, so that the field is read without turning its gradient back.
class FieldRows
{
public:
  /// \param distance gate of the surface's residuals, metres
  FieldRows(const TrainedModel& model, const Pose& T_object_camera, double distance, double max_normal_angle)
      : field_(model.field),
        T_object_camera_(T_object_camera.cast<float>()),
        middle_(model.center.cast<float>()),
        inverse_radius_(static_cast<float>(1 / radius(model))),
        gate_(static_cast<float>(distance)),
        min_cosine_(static_cast<float>(std::cos(max_normal_angle))),
        edge_step_(EDGE_STEP * static_cast<float>(model.parameters.leaf))
  {}

  static double radius(const TrainedModel& model) { return model.size.norm() / 2; }

  /// Of the points from `first` on, as many as a block holds: a measured surface point has no distance from the
  /// surface.
  void ofSurface(const OrientedPoints& surface, std::size_t first, FieldRowBlock& rows) const;

  /// A step outside of a measured edge the distance is the step.
  FieldRow ofEdge(const Eigen::Vector3f& point, const Eigen::Vector3f& out) const
  {
    // An edge is known to about half a pixel of the working grid, a sixth of a leaf, and a surface several times
    // better; but the errors of neighbouring pixels are alike, so that many say no more than one.
    constexpr float WEIGHT = 0.3f;
    constexpr float MIN_COSINE = 0.7f;  // beside a concave corner of the outline another side of the part is nearer
    const Eigen::Vector3f outward = T_object_camera_.linear() * out;
    const Eigen::Vector3f p = T_object_camera_ * point + edge_step_ * outward;
    const DistanceField::Sample sample = field_.sample(p);
    const float residual = sample.distance - edge_step_;
    FieldRow row{(p - middle_) * inverse_radius_, sample.gradient, residual, WEIGHT * biweight(residual, edge_step_)};
    if (outward.dot(sample.gradient) <= MIN_COSINE * sample.gradient.norm())
      row.weight = 0;
    return row;
  }

private:
  static constexpr float EDGE_STEP = 0.75f;  // of the leaf: half of the field's band

  /// Tukey's biweight at the gate: a neighbour's surface just inside it pulls little. 0 outside.
  static float biweight(float residual, float gate)
  {
    const float share = residual / gate;
    const float root = std::max(0.0f, 1 - share * share);
    return root * root;
  }

  const DistanceField& field_;
  Eigen::Isometry3f T_object_camera_;
  Eigen::Vector3f middle_;
  float inverse_radius_;
  float gate_;
  float min_cosine_;
  float edge_step_;
};

/// Sums of the weighted products of rows' columns.
class RowSums
{
public:
  void add(const FieldRowBlock& rows);
  void add(const FieldRow& row);

  int count() const { return count_; }  ///< of rows that say something
  double weight() const { return total(PAIRS); }
  /// \pre i <= j
  double product(std::size_t i, std::size_t j) const { return total(index(i, j)); }

  static constexpr std::size_t LANES = 16;
  static constexpr std::size_t COLUMNS = FieldRowBlock::COLUMNS;
  static constexpr std::size_t PAIRS = COLUMNS * (COLUMNS + 1) / 2;

private:
  static std::size_t index(std::size_t i, std::size_t j) { return i * COLUMNS - i * (i + 1) / 2 + j; }
  double total(std::size_t k) const;

  std::array<std::array<double, LANES>, PAIRS + 1> sums_ = {};  ///< the last: of the weights
  int count_ = 0;
};

/// The pose moved by a solution of the rows. \param x rotation times the part's radius, then translation
Pose movedBy(const Vector6d& x, const Pose& T_object_camera, const TrainedModel& model);
}  // namespace bin_picking
