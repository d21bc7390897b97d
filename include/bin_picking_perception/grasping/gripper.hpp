// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"

namespace bin_picking
{
/// A box, axis-aligned in the tip frame (Z = approach, Y = closing, origin between the finger tips).
struct GripperBox
{
  std::string name;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< metres, at opening 0
  Eigen::Vector3d size = Eigen::Vector3d::Zero();    ///< metres
  int finger = 0;                                    ///< 0: fixed to the palm; +1 / -1: moves by +-opening / 2 along Y
};

struct Gripper
{
  std::string name;
  double max_opening = 0;  ///< metres
  std::vector<GripperBox> boxes;
};

/// \throws FileError missing file, unknown key, no boxes, sizes not positive
Gripper loadGripper(const std::string& path);
}  // namespace bin_picking
