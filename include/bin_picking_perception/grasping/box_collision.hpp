// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "bin_picking_perception/common/oriented_points.hpp"

namespace bin_picking
{
/// A box in any orientation, given in one common frame with the boxes that it is held against.
struct OrientedBox
{
  Pose T_frame_box = Pose::Identity();                  ///< the box frame: origin in the middle, axes along the edges
  Eigen::Vector3d half_size = Eigen::Vector3d::Zero();  ///< metres
};

/// Signed clearance of two boxes by separating axes, metres.
/// Overlapping: minus the exact penetration depth (the shortest motion that would part them).
/// Apart: a lower bound of the distance, exact where a face or two crossing edges are nearest; where two corners are,
/// the true distance is at most sqrt(3) times larger.
double boxClearance(const OrientedBox& a, const OrientedBox& b);

/// The same for everything that `moving` sweeps over while it moves straight by `motion` (metres, common frame). The
/// swept volume is treated as it is, not by steps: nothing thin is jumped over.
double sweptBoxClearance(const OrientedBox& moving, const Eigen::Vector3d& motion, const OrientedBox& fixed);
}  // namespace bin_picking
