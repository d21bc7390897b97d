// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "sweep_lanes.hpp"

#include <algorithm>
#include <limits>

#include "../common/simd.hpp"

namespace bin_picking
{
namespace
{
constexpr float NEVER = std::numeric_limits<float>::max();
constexpr float PARALLEL = 1e-20f;  // in place of zero, so that the crossing lies far off on the right side

BIN_PICKING_SIMD unsigned meetRows(const float* planes, std::size_t count, const float* ray, const float* step,
                                   float near, Lanes* lanes)
{
  unsigned rows = 0;
  for (int row = 0; row < BLOCK; ++row)
  {
    float distance[BLOCK];
    float enters[BLOCK];
    float leaves[BLOCK];
    for (int k = 0; k < BLOCK; ++k)
    {
      distance[k] = -NEVER;
      enters[k] = lanes->allowed[row][k];
      leaves[k] = NEVER;
    }
    const float ray_y = ray[1] + static_cast<float>(row) * step[1];
    for (std::size_t i = 0; i < count; ++i)
    {
      const float* plane = planes + 4 * i;
      // Along a ray, the height over the plane grows by this for each metre of depth.
      const float along_first = plane[0] * ray[0] + plane[1] * ray_y + plane[2];
      const float along_step = plane[0] * step[0];
      const float offset = plane[3];
      for (int k = 0; k < BLOCK; ++k)
      {
        const float raw = along_first + along_step * static_cast<float>(k);
        const float along = raw == 0.0f ? PARALLEL : raw;
        const float height = along * lanes->depth[row][k] + offset;
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
      const float beyond = leaves[k] > enters[k] ? leaves[k] - lanes->allowed[row][k] : 0.0f;
      lanes->distance[row][k] = distance[k];
      lanes->beyond[row][k] = beyond;
      nearest = distance[k] < nearest ? distance[k] : nearest;
      farthest = beyond > farthest ? beyond : farthest;
    }
    rows |= nearest < near || farthest > 0 ? 1u << row : 0u;
  }
  return rows;
}

bool reaches(float deepest, const float* nearest)
{
  int any = 0;
  for (int k = 0; k < BLOCK; ++k)
    any |= nearest[k] <= deepest ? 1 : 0;
  return any != 0;
}

/// Along a line in the picture the inverse depth of a plane is linear, so that the corners of a block bound it.
BIN_PICKING_SIMD unsigned meetBlocks(const float* planes, std::size_t count, const float* ray, const float* step,
                                     float around, const float* nearest)
{
  float enters[BLOCK];
  float leaves[BLOCK];
  for (int k = 0; k < BLOCK; ++k)
  {
    enters[k] = 0.0f;
    leaves[k] = NEVER;
  }
  for (std::size_t i = 0; i < count; ++i)
  {
    const float* plane = planes + 4 * i;
    const float first = plane[0] * ray[0] + plane[1] * ray[1] + plane[2];
    const float across = plane[0] * step[0] * static_cast<float>(BLOCK - 1);
    const float down = plane[1] * step[1] * static_cast<float>(BLOCK - 1);
    const float least = first + (across < 0.0f ? across : 0.0f) + (down < 0.0f ? down : 0.0f);
    const float most = first + (across > 0.0f ? across : 0.0f) + (down > 0.0f ? down : 0.0f);
    const float to_next = plane[0] * step[0] * static_cast<float>(BLOCK);
    const float offset = around - plane[3];
    const bool is_behind = offset > 0.0f;  // the plane, seen from the camera
    for (int k = 0; k < BLOCK; ++k)
    {
      const float low = least + to_next * static_cast<float>(k);
      const float high = most + to_next * static_cast<float>(k);
      const float slow = is_behind ? low : high;
      const float leaving = offset / (slow > 0.0f ? slow : PARALLEL);
      const float entering = is_behind ? 0.0f : offset / (low < 0.0f ? low : -PARALLEL);
      leaves[k] = low > 0.0f && leaving < leaves[k] ? leaving : leaves[k];
      enters[k] = high < 0.0f && entering > enters[k] ? entering : enters[k];
    }
  }
  unsigned blocks = 0;
  for (int k = 0; k < BLOCK; ++k)
    blocks |= leaves[k] >= nearest[k] && enters[k] <= leaves[k] ? 1u << k : 0u;
  return blocks;
}

BIN_PICKING_SIMD void raiseToHeights(const float* plane, const float* __restrict x, const float* __restrict y,
                                     const float* __restrict z, std::size_t count, float* __restrict distances)
{
  const float nx = plane[0];
  const float ny = plane[1];
  const float nz = plane[2];
  const float offset = plane[3];
  for (std::size_t k = 0; k < count; ++k)
  {
    const float height = nx * x[k] + ny * y[k] + nz * z[k] + offset;
    distances[k] = height > distances[k] ? height : distances[k];
  }
}

BIN_PICKING_SIMD void boundBlock(const float* values, const float* depth, const std::uint8_t* measured,
                                 std::size_t stride, float far_away, BlockDepths* bounds)
{
  float least[BLOCK];
  float nearest_point[BLOCK];
  float farthest_point[BLOCK];
  for (int k = 0; k < BLOCK; ++k)
  {
    least[k] = values[k];
    nearest_point[k] = far_away;
    farthest_point[k] = 0.0f;
  }
  for (int row = 0; row < BLOCK; ++row, values += stride, depth += stride, measured += stride)
    for (int k = 0; k < BLOCK; ++k)
    {
      const float point = measured[k] != 0 ? depth[k] : far_away;
      const float farther = measured[k] != 0 ? depth[k] : 0.0f;
      least[k] = values[k] < least[k] ? values[k] : least[k];
      nearest_point[k] = point < nearest_point[k] ? point : nearest_point[k];
      farthest_point[k] = farther > farthest_point[k] ? farther : farthest_point[k];
    }
  *bounds = {least[0], far_away, 0.0f};
  for (int k = 0; k < BLOCK; ++k)
  {
    bounds->least = least[k] < bounds->least ? least[k] : bounds->least;
    bounds->nearest_point = nearest_point[k] < bounds->nearest_point ? nearest_point[k] : bounds->nearest_point;
    bounds->farthest_point = farthest_point[k] > bounds->farthest_point ? farthest_point[k] : bounds->farthest_point;
  }
}

/// Four numbers a plane.
const float* dataOf(const Planes& planes) { return planes.empty() ? nullptr : planes.front().data(); }
}  // namespace

unsigned mayMeet(const Planes& planes, float deepest, const Eigen::Vector3f& ray, const Eigen::Vector2f& step,
                 float around, const float* nearest)
{
  if (!reaches(deepest + around, nearest))  // most of a gripper stays above everything
    return 0;
  return meetBlocks(dataOf(planes), planes.size(), ray.data(), step.data(), around, nearest);
}

unsigned meet(const Planes& planes, const Eigen::Vector3f& ray, const Eigen::Vector2f& step, float near, Lanes& lanes)
{
  return meetRows(dataOf(planes), planes.size(), ray.data(), step.data(), near, &lanes);
}

BlockDepths depthsOfBlock(const float* values, const float* depth, const std::uint8_t* measured, std::size_t stride,
                          float far_away)
{
  BlockDepths bounds;
  boundBlock(values, depth, measured, stride, far_away, &bounds);
  return bounds;
}

void signedDistances(const Planes& planes, const float* x, const float* y, const float* z, std::size_t count,
                     float* distances)
{
  std::fill_n(distances, count, -NEVER);
  for (const Eigen::Vector4f& plane : planes)
    raiseToHeights(plane.data(), x, y, z, count, distances);
}

namespace
{
BIN_PICKING_SIMD void raiseToAhead(float* values, std::size_t count, std::size_t ahead)
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
