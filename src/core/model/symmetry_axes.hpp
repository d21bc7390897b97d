// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/model/distance_field.hpp"
#include "bin_picking_perception/model/part.hpp"

namespace bin_picking
{
/// A surface as far as its mass distribution restricts the axes that it can be symmetric about.
struct Inertia
{
  explicit Inertia(const std::vector<Eigen::Vector3f>& surface);

  Eigen::AlignedBox3d box;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();    ///< of the area
  Eigen::Vector3d moments = Eigen::Vector3d::Zero();   ///< of the scatter, ascending
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns: principal directions, as the moments
};

/// Axes of the drawing through its origin, the box's and the area's centre, and the principal axes: each line once.
std::vector<Symmetry::Axis> candidateAxes(const Inertia& inertia);

/// Directions in the plane of two equal moments of inertia, or all around if the three are equal; none if they differ.
/// Axes of symmetry that the moments do not fix lie within a few degrees of one of them.
std::vector<Eigen::Vector3d> undecidedDirections(const Inertia& inertia);

/// Mean distance of the turned points from the surface, cut at the field's band.
double meanDistance(const std::vector<Eigen::Vector3f>& points, const DistanceField& field, const Pose& T);

/// The rotation by the same angle whose axis is nearby and keeps the points nearest to the surface (least squares).
/// \param last_gate metres: what is off by more does not count in the last step; in the first all within the field's
/// band do, and infinity lets them count to the end \return its axis, or the given one where the points slide away to
/// another angle
Symmetry::Axis refinedAxis(const std::vector<Eigen::Vector3f>& points, const DistanceField& field,
                           const Symmetry::Axis& axis, double angle, double last_gate);

/// Share of the points that a motion takes off the surface by more than the tolerance.
double brokenShare(const std::vector<Eigen::Vector3f>& points, const DistanceField& field, const Pose& T,
                   double tolerance);

/// The axis as the turn about it that keeps the surface best would have it, whatever breaks it: boxes and moments of
/// inertia give the axis of what is almost symmetric only roughly. \param tolerance metres: what is off by more breaks
/// \return the given axis where that is no better
Symmetry::Axis settledAxis(const std::vector<Eigen::Vector3f>& points, const DistanceField& field,
                           const Symmetry::Axis& axis, double tolerance);
}  // namespace bin_picking
