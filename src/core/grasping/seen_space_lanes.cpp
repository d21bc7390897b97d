// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "seen_space_lanes.hpp"

#include <limits>

namespace bin_picking
{
bool meet(const Planes& planes, const Eigen::Vector3f& ray, float step, float near, Lanes& lanes)
{
  constexpr float NEVER = std::numeric_limits<float>::max();
  constexpr float PARALLEL = 1e-20f;  // in place of zero, so that the crossing lies far off on the right side
  float distance[BLOCK];
  float enters[BLOCK];
  float leaves[BLOCK];
  for (int k = 0; k < BLOCK; ++k)
  {
    distance[k] = -NEVER;
    enters[k] = lanes.allowed[k];
    leaves[k] = NEVER;
  }
  for (const Eigen::Vector4f& plane : planes)
  {
    const float along_first = plane.head<3>().dot(ray);
    const float along_step = plane.x() * step;
    const float offset = plane.w();
    for (int k = 0; k < BLOCK; ++k)
    {
      const float raw = along_first + along_step * static_cast<float>(k);
      const float along = raw == 0.0f ? PARALLEL : raw;
      const float height = along * lanes.depth[k] + offset;
      distance[k] = height > distance[k] ? height : distance[k];
      const float crossing = -offset / along;
      const float later = crossing > enters[k] ? crossing : enters[k];
      const float earlier = crossing < leaves[k] ? crossing : leaves[k];
      enters[k] = along < 0.0f ? later : enters[k];
      leaves[k] = along > 0.0f ? earlier : leaves[k];
    }
  }
  float nearest = NEVER;
  float farthest = 0;
  for (int k = 0; k < BLOCK; ++k)
  {
    lanes.distance[k] = distance[k];
    lanes.beyond[k] = leaves[k] > enters[k] ? leaves[k] - lanes.allowed[k] : 0.0f;
    nearest = distance[k] < nearest ? distance[k] : nearest;
    farthest = lanes.beyond[k] > farthest ? lanes.beyond[k] : farthest;
  }
  return nearest < near || farthest > 0;
}

namespace
{
void raiseToAhead(float* values, std::size_t count, std::size_t ahead)
{
  for (std::size_t i = 0; i + ahead < count; ++i)
    values[i] = values[i + ahead] > values[i] ? values[i + ahead] : values[i];
}
}  // namespace

void raiseToWindow(float* values, std::size_t count, std::size_t step, std::size_t window)
{
  std::size_t covered = 1;
  for (; 2 * covered <= window; covered *= 2)
    raiseToAhead(values, count, covered * step);
  if (covered < window)
    raiseToAhead(values, count, (window - covered) * step);
}
}  // namespace bin_picking
