// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>

namespace bin_picking_ros
{
/// The file that a parameter names: package://PACKAGE/PATH, file:///PATH or an absolute path.
/// \throws bin_picking::ParameterError unknown package, or a relative path: a node has no working folder that users
/// know
std::string resolveResource(const std::string& resource);

/// Where ROS nodes keep their files: $ROS_HOME, else ~/.ros.
std::string rosHome();
}  // namespace bin_picking_ros
