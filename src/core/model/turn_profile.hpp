// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/model/distance_field.hpp"
#include "bin_picking_perception/model/part.hpp"

namespace bin_picking
{
/// A turn about an axis of which it is asked whether it nearly keeps the surface.
struct TriedTurn
{
  double angle = 0;     ///< rad
  bool is_gap = false;  ///< where the surface is worst off beside a turn that stands out: no rival, but not passed over

  bool operator<(const TriedTurn& other) const { return angle < other.angle; }
};

/// Ascending, from no turn to before a full one, alike in either direction: even steps of a turn / NEAR_SYMMETRY_STEPS,
/// but in place of those beside them the turns at which the surface falls back onto itself, with the gaps between.
/// \param points of the surface that the field belongs to
std::vector<TriedTurn> anglesToTry(const std::vector<Eigen::Vector3f>& points, const DistanceField& field,
                                   const Symmetry::Axis& axis);
}  // namespace bin_picking
