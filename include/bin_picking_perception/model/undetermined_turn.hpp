// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/model/part.hpp"

namespace bin_picking
{
/// What a view leaves open of a pose: the part may as well be turned about an axis, since what tells the turn is slight
/// and not seen. Position and axis are known.
struct UndeterminedTurn
{
  Symmetry::Axis axis;         ///< part frame
  std::vector<double> angles;  ///< the other turns that it may have, rad, (0, 2 pi), ascending; empty: any
  double deviation = 0;        ///< metres: by so much at most the surface differs from one of these turns to another
};

/// "its turn about the axis z through (0.00, 0.00, 0.00) mm is not known: what tells it, up to 5.00 mm high or deep, is
/// not seen".
std::string describe(const UndeterminedTurn& turn);

/// All motions of the part frame that lead from a pose to one that it may as well be, the identity first: the turns,
/// each followed by every symmetry. An axis of revolution and an open turn are sampled at `steps` angles. \throws
/// ParameterError steps < 1
std::vector<Pose> sampledTurns(const UndeterminedTurn& turn, const Symmetry& symmetry, int steps);

/// Of the poses that a pose may as well be, symmetry and turn considered, the one that is nearest in rotation to
/// `reference`.
Pose nearestTurned(const Pose& T_camera_object, const Pose& reference, const UndeterminedTurn& turn,
                   const Symmetry& symmetry);
}  // namespace bin_picking
