// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/model/distance_field.hpp"
#include "bin_picking_perception/model/part.hpp"

namespace bin_picking
{
/// A motion that maps much of a part onto itself, but not all of it: a view of the rest is needed to tell the two
/// apart.
struct NearSymmetry
{
  Pose T_object_object = Pose::Identity();
  Symmetry::Axis axis;  ///< of the turn
  double broken = 0;    ///< share of the surface that it moves off the surface, (0, 1)
};

/// Turns about the box's and the principal axes that keep most of the surface. Declared symmetries are not among them.
/// \param surface of the part, even. \param tolerance metres: what is moved off the surface by less counts as kept
std::vector<NearSymmetry> findNearSymmetries(const OrientedPoints& surface, const DistanceField& field,
                                             const Symmetry& declared, double tolerance);
}  // namespace bin_picking
