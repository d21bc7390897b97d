// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "moved_points.hpp"

#include "../common/simd.hpp"

namespace bin_picking
{
BIN_PICKING_SIMD void movePoints(const float* points, std::size_t count, const Motion& motion,
                                 DistanceField::Places& moved)
{
  const std::array<float, 9> r = motion.rotation;
  const std::array<float, 3> t = motion.translation;
  for (std::size_t k = 0; k < count; ++k)
  {
    const float x = points[3 * k];
    const float y = points[3 * k + 1];
    const float z = points[3 * k + 2];
    moved.x[k] = r[0] * x + r[1] * y + r[2] * z + t[0];
    moved.y[k] = r[3] * x + r[4] * y + r[5] * z + t[1];
    moved.z[k] = r[6] * x + r[7] * y + r[8] * z + t[2];
  }
}
}  // namespace bin_picking
