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
  Eigen::AlignedBox3d box_bin;
};

/// The walls stand on the floor and end at the rim; the floor reaches under them.
std::vector<BinSide> binSides(const Bin& bin);

/// Whether boxes along the same axes are farther apart than the distance along one of them.
inline bool areApart(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b, double distance)
{
  return ((a.min() - b.max()).array() > distance).any() || ((b.min() - a.max()).array() > distance).any();
}
}  // namespace bin_picking
