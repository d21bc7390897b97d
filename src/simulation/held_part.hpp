// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "grip_scene.hpp"

namespace bin_picking::simulation
{
/// What the held part runs into.
struct HeldTouch
{
  double time = 0;  ///< share of the way out, [0, 1]
  std::size_t mesh = 0;
  double depth = 0;  ///< deeper than at rest, metres
};

/// Moves the target of the scene, held fast, on the way out. It may reach bin_play deeper into the bin than at rest,
/// and max_drag deeper into another part. \param shift_bin by which closing moved it before \param step between the
/// places that are looked at for other parts, metres; against the bin the whole way is tested at once
std::optional<HeldTouch> firstTouchOfHeld(const GripScene& scene, const Eigen::Vector3d& shift_bin,
                                          const Eigen::Vector3d& motion_bin, const GripTrialParameters& parameters);
}  // namespace bin_picking::simulation
