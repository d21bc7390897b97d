// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>

#include "bin_picking_perception/common/oriented_points.hpp"

namespace bin_picking
{
/// An open box. Frame: origin in the middle of the inner floor, z up, x along the long side.
struct Bin
{
  Pose T_camera_bin = Pose::Identity();
  Eigen::Vector3d inner_size = Eigen::Vector3d::Zero();  ///< length, width, height, metres
  double wall_thickness = 0.01;                          ///< metres
};

/// Reads `pose: {position, orientation [qx,qy,qz,qw]}`, `inner_size`, optional `wall_thickness`.
/// \throws FileError missing file or key, unknown key, sizes not positive, quaternion not of unit length (1e-3)
Bin loadBin(const std::string& path);
}  // namespace bin_picking
