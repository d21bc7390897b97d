// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Transform.h>

#include "bin_picking_perception/common/oriented_points.hpp"

namespace bin_picking_ros
{
/// \throws std::logic_error if the pose is not finite: such a pose must never reach a robot
geometry_msgs::Pose toPoseMessage(const bin_picking::Pose& pose);
geometry_msgs::Transform toTransformMessage(const bin_picking::Pose& pose);

/// The quaternion is normalised. \throws RequestError(INVALID_ARGUMENT) if a number is not finite or the quaternion is
/// not of unit length (within 1e-3): an all-zero one is what a forgotten orientation looks like
bin_picking::Pose fromMessage(const geometry_msgs::Pose& message);
bin_picking::Pose fromMessage(const geometry_msgs::Transform& message);
}  // namespace bin_picking_ros
