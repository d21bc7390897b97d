// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/grasping/convex_body.hpp"
#include "bin_picking_perception/scene/bin.hpp"

namespace bin_picking
{
/// One of the five solid boxes of a bin.
struct BinSide
{
  std::string name;    ///< "floor", "wall at +x", ...
  bool floor = false;  ///< or a wall
  ConvexBody box;      ///< camera frame
};

/// The walls stand on the floor and end at the rim; the floor reaches under them.
std::vector<BinSide> binSides(const Bin& bin);

/// Whether a body that moves straight stays that far from all sides, because it stays over the rim, or within the walls
/// and over the floor. If not, it may still. \param T_bin_body, motion_bin of the body, metres
bool isWellInside(const ConvexBody& body, const Pose& T_bin_body, const Eigen::Vector3d& motion_bin, const Bin& bin,
                  double distance);
}  // namespace bin_picking
