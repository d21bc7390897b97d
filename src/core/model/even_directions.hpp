// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

namespace bin_picking
{
/// Unit vectors spread evenly over the sphere along a Fibonacci spiral, from +z to -z.
inline std::vector<Eigen::Vector3d> evenDirections(int count)
{
  constexpr double GOLDEN_ANGLE = 2.39996322972865332;
  std::vector<Eigen::Vector3d> directions;
  directions.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
  {
    const double z = 1 - (2.0 * i + 1) / count;
    const double radius = std::sqrt(1 - z * z);
    directions.emplace_back(radius * std::cos(GOLDEN_ANGLE * i), radius * std::sin(GOLDEN_ANGLE * i), z);
  }
  return directions;
}
}  // namespace bin_picking
