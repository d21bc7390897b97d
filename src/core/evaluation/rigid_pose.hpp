// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>

#include "bin_picking_perception/common/oriented_points.hpp"

namespace bin_picking
{
/// What keeps R and t from being a rigid motion, as the end of a sentence that begins with what they are; empty:
/// nothing. Up to 0.001 in any entry of R^T R is taken as the rounding of a file.
std::string rigidityFault(const Eigen::Matrix3d& R, const Eigen::Vector3d& t);

/// \param origin what is read and where. \throws FileError it is no rigid motion
Pose rigidPose(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, const std::string& origin);
}  // namespace bin_picking
