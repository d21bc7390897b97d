// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "bullet_body.hpp"
#include "random.hpp"

namespace bin_picking::simulation
{
/// Where a part is let go.
struct DropSpace
{
  Eigen::Vector3d inner_size;                      ///< of the bin, metres
  double clearance = 0;                            ///< free height below the part, metres
  std::vector<Eigen::AlignedBox3d> occupied = {};  ///< by what lies in the bin already, frame of the bin
};

/// A random place between the walls and a random attitude, just above what lies there. \return T_bin_body
/// \throws ParameterError the part is too large for the bin
Pose randomDrop(const BulletShape& shape, const DropSpace& space, Random& random);
}  // namespace bin_picking::simulation
