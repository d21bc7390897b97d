// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <optional>
#include <vector>

#include "bin_picking_perception/model/part.hpp"

namespace bin_picking
{
/// Within which two rotations of a symmetry group are one.
struct SymmetryTolerance
{
  double angle = 0.00175;  ///< rad
  double position = 1e-6;  ///< metres
};

/// closeUnderComposition with another tolerance, for rotations that were measured and not written down.
std::vector<Pose> closeUnderComposition(const std::vector<Pose>& generators, const SymmetryTolerance& tolerance);

/// Whether a rotation maps an axis of revolution onto itself, in either direction.
bool keepsAxis(const Pose& rotation, const Symmetry::Axis& axis, const SymmetryTolerance& tolerance);

/// The symmetry that a list of rotations and perhaps an axis of revolution generate.
/// \param rotations keep the axis, if there is one
/// \throws ParameterError they do not generate a finite group
Symmetry generateSymmetry(const std::vector<Pose>& rotations, const std::optional<Symmetry::Axis>& axis,
                          const SymmetryTolerance& tolerance = {});
}  // namespace bin_picking
