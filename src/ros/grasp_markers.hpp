// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <vector>

#include "bin_picking_perception/grasping/gripper.hpp"
#include "message_conversion.hpp"

namespace bin_picking_ros
{
constexpr std::size_t MAX_REJECTED_GRASPS = 5;  ///< shown; more would hide the parts

/// The way of a grasp, and the gripper at its end as it comes in, opened.
void addGrasp(const bin_picking::Grasp& grasp, const bin_picking::Gripper& gripper, const OutputFrame& output,
              visualization_msgs::MarkerArray& markers);

/// The first grasp of each reason, with the reason.
void addRejectedGrasps(const std::vector<bin_picking::Grasp>& rejected, const OutputFrame& output,
                       visualization_msgs::MarkerArray& markers);

/// Places whose parts are not offered.
void addAvoided(const std::vector<bin_picking::AvoidedPlace>& places, const OutputFrame& output,
                visualization_msgs::MarkerArray& markers);
}  // namespace bin_picking_ros
