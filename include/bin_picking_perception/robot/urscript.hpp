// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>

#include "bin_picking_perception/common/oriented_points.hpp"

namespace bin_picking
{
/// Poses in the words of URScript, the language of Universal Robots' controllers. A pose is p[x, y, z, rx, ry, rz] in
/// the frame `base` (not ROS' `base_link`, see Robot), metres; (rx, ry, rz) is the axis of the rotation times its angle
/// in radians.

/// The rotation vector of the smallest turn. Of the two that mean the same half turn, the one whose first component
/// that is not zero is positive.
Eigen::Vector3d rotationVector(const Eigen::Matrix3d& rotation);
Eigen::Matrix3d rotationFromVector(const Eigen::Vector3d& vector);

/// "p[0.4, -0.1, 0.25, 3.1415926536, 0, 0]", rounded to 1e-10. \throws ParameterError a pose that is not rigid or not
/// finite
std::string toUrScript(const Pose& T_base_tcp);

/// "movel(p[...], a=1.2, v=0.25)": a straight move of the tool centre point that is active in the controller. With
/// set_tcp(p[0, 0, 0, 0, 0, 0]) that is tool0.
/// \param acceleration m/s^2 \param speed m/s
/// \throws ParameterError a pose as above; acceleration or speed not positive
std::string toUrScriptMove(const Pose& T_base_tcp, double acceleration = 1.2, double speed = 0.25);

/// The pose of the first p[...] in a text. \throws ParameterError no p[...] of six finite numbers
Pose fromUrScript(const std::string& text);
}  // namespace bin_picking
