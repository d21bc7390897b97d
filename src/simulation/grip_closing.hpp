// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "grip_scene.hpp"

namespace bin_picking::simulation
{
/// How closing ended.
struct Closing
{
  std::optional<Touch> touch;  ///< of something that must not be touched; `time` has no meaning
  std::string missed;          ///< why nothing is held as it should be; empty: held or collided
  double opening = 0;          ///< at the end, metres
  double shift = 0;            ///< of the target along Y of the tip, metres
};

/// Moves the fingers inwards from path.opening until both press the target. Chooses the target if the scene has none:
/// the first part that a pad touches.
Closing closeFingers(GripScene& scene, const Gripper& gripper, const GripPath& path,
                     const GripTrialParameters& parameters);

/// Whether the lip of a suction gripper meets the surface of one part all round. Chooses the target likewise.
Closing seal(GripScene& scene, const Gripper& gripper, const GripPath& path, const GripTrialParameters& parameters);
}  // namespace bin_picking::simulation
