// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/model/part.hpp"

namespace bin_picking
{
/// One of the ways in which a grasp of a part may be taken.
struct GraspVariant
{
  std::size_t grasp = 0;     ///< index into PartDefinition::grasps
  int symmetry_variant = 0;  ///< index into Symmetry::sampled(continuous_steps); 0: as written
  double tilt = 0;           ///< about the closing axis, rad, within +-tilt_tolerance
  double spin = 0;           ///< about the approach axis, rad, within +-spin_tolerance
  Pose T_object_tip = Pose::Identity();
  Pose T_tip_object = Pose::Identity();  ///< where the part is in the hand: what placing it has to correct for
};

/// All ways to take a part: each grasp by the part's symmetry (if it is `symmetric`), turned and tilted by its
/// tolerances, each sampled at 0, +-half and +-all of it:
///   T_object_tip = T_object_symmetric * T_written * turn(Z, spin) * turn(Y, tilt).
///
/// First come all as written and their symmetric copies, in the order of the grasps, then those that use a tolerance,
/// the smaller before the larger. Of variants that equal each other, also of several grasps, one is kept: that which
/// uses less of its tolerances, then that of the higher priority, then the first. Equal are poses to 0.1 mm and 0.1
/// degrees, width and opening to 0.1 mm. Deterministic.
/// \param continuous_steps copies about an axis of revolution \throws ParameterError continuous_steps < 1
std::vector<GraspVariant> expandGrasps(const PartDefinition& part, int continuous_steps);

/// One grasp as written, with its tolerances but not its symmetric copies: what has to be true of it.
std::vector<GraspVariant> expandTolerances(const GraspDefinition& grasp);
}  // namespace bin_picking
