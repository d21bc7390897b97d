// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking
{
/// Two places of a surface that look away from each other.
struct OpposedPoints
{
  Eigen::Vector3d middle;
  Eigen::Vector3d axis;  ///< unit, from one to the other
  double width = 0;      ///< metres
};

/// Pairs of sampled points with what lies opposite along their normal, inclined by no more than `max_angle` (rad) and
/// at most `max_width` apart. Of pairs that nearly coincide (middle within `spacing`, axis within 15 degrees) the first
/// is kept. Deterministic.
std::vector<OpposedPoints> opposedPoints(const TriangleMesh& mesh, double max_width, double max_angle, double spacing);
}  // namespace bin_picking
