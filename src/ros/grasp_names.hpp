// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "pick_memory.hpp"
#include "pick_pipeline.hpp"

namespace bin_picking_ros
{
/// Four letters and digits that another start of the node will hardly have again.
std::string runName();

/// Gives each grasp its uid, <answer>-<k>. \return what is to be remembered of them
std::vector<PickMemory::GivenGrasp> nameGrasps(PickResult& result, const std::string& answer,
                                               const bin_picking::Pose& T_fixed_camera);

/// Has the parts of a cloud asked for in the frame of the memory.
AvoidQuery avoidQuery(PickMemory& memory, const bin_picking::Pose& T_fixed_camera);

/// All places that are avoided now, in the cloud's frame.
std::vector<bin_picking::AvoidedPlace> placesInCamera(PickMemory& memory, const bin_picking::Pose& T_fixed_camera);
}  // namespace bin_picking_ros
