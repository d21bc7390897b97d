// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/model/distance_field.hpp"
#include "bin_picking_perception/model/part.hpp"
#include "bin_picking_perception/model/symmetry_search.hpp"

namespace bin_picking
{
/// A motion that maps much of a part onto itself, but not all of it: a view of the rest is needed to tell the two
/// apart.
struct NearSymmetry
{
  Pose T_object_object = Pose::Identity();
  Symmetry::Axis axis;  ///< of the turn
  double broken = 0;    ///< share of the surface that it moves off the surface, (0, 1)
  /// Hausdorff distance of the surface from where it was, metres: the height of what tells the two apart.
  double deviation = 0;
  /// The deviation is within the limit, or within twice the limit where no more than SMALL_FEATURE is broken, and the
  /// turn is truly another one: not a small one that slides along the surface.
  bool slight = false;
  /// Every turn about the axis is slight or a symmetry: the part is a body of revolution but for something slight.
  bool slight_all_around = false;
};

/// Share of the surface. A hand that fits one turn fits another that moves no surface by much; of a feature as small as
/// this it rarely meets any.
constexpr double SMALL_FEATURE = 0.06;

/// Near symmetries about one axis come in steps of a turn / NEAR_SYMMETRY_STEPS, but for turns at which the surface
/// falls back onto itself, as a gear does tooth by tooth: those take the place of the steps beside them.
constexpr int NEAR_SYMMETRY_STEPS = 24;

/// Turns that keep most of the surface, about the box's and the principal axes, each moved to where the best of its
/// turns has it: what breaks a symmetry draws these axes aside, and a rival beside its place is none. Declared
/// symmetries are not among them.
///
/// \param surface of the part, even
/// \param tolerance metres: what is moved off the surface by less counts as kept
/// \param exact the same surface, for the deviation: the field is cut at its band
/// \param slight_deviation metres: the limit of NearSymmetry::slight
std::vector<NearSymmetry> findNearSymmetries(const OrientedPoints& surface, const DistanceField& field,
                                             const SelfComparison& exact, const Symmetry& declared, double tolerance,
                                             double slight_deviation);

/// Whether two axes are one line to within a length (metres), whatever their directions' signs.
bool isSameLine(const Symmetry::Axis& a, const Symmetry::Axis& b, double tolerance);
}  // namespace bin_picking
