// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// What a body meets on the rays of the camera.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "own_pixels.hpp"
#include "seen_space.hpp"

namespace bin_picking
{
template <typename Points>
SeenSpace::Window SeenSpace::windowOf(const Points& points, float margin) const
{
  Eigen::AlignedBox2f window;
  for (const auto& point : points)
  {
    const Eigen::Vector3f& p = point.template cast<float>();  // a temporary lives as long as its reference
    if (p.z() < MIN_DEPTH)
      return {0, 0, width_, height_};
    const float z = std::max(MIN_DEPTH, p.z() - margin);
    const Eigen::Vector2f around(margin * fx_ / z, margin * fy_ / z);
    const Eigen::Vector2f pixel(p.x() * fx_ / p.z() + cx_, p.y() * fy_ / p.z() + cy_);
    window.extend(Eigen::Vector2f(pixel - around));
    window.extend(Eigen::Vector2f(pixel + around));
  }
  const auto cut = [](float value, int size) {
    return static_cast<int>(std::clamp(value, -1.0f, static_cast<float>(size)));
  };
  return {std::max(0, cut(std::floor(window.min().x()), width_)),
          std::max(0, cut(std::floor(window.min().y()), height_)),
          std::min(width_, cut(std::ceil(window.max().x()), width_) + 1),
          std::min(height_, cut(std::ceil(window.max().y()), height_) + 1)};
}

template SeenSpace::Window SeenSpace::windowOf(const std::vector<Eigen::Vector3f>&, float) const;

struct SeenSpace::Search
{
  const SeenSpace& space;
  const BodySweep& body;
  const PixelOwners& owners;
  Encounter surface;
  Encounter unseen;

  void block(int u, int v)
  {
    Lanes lanes;
    for (int row = 0; row < BLOCK; ++row)
    {
      const std::size_t first = space.index(u, v + row);
      std::memcpy(lanes.depth[row], &space.depth_[first], sizeof(lanes.depth[row]));
      for (int k = 0; k < BLOCK; ++k)
      {
        // Whose the pixel is, is asked later and of few; what comes near to the end of what is allowed is told too.
        const std::size_t i = first + static_cast<std::size_t>(k);
        const float least = std::min({space.allowed_[i], space.allowed_own_[i], space.allowed_unknown_[i]});
        lanes.allowed[row][k] = least - LOOK_AHEAD;
      }
    }
    const unsigned rows = meet(body.planes, space.ray(u, v), space.step_, LOOK_AHEAD, lanes);
    for (int row = 0; row < BLOCK; ++row)
      for (int k = 0; rows >> row & 1 && k < BLOCK; ++k)
        keep(lanes.distance[row][k], lanes.allowed[row][k], lanes.beyond[row][k], u + k, v + row);
  }

  void keep(float distance, float allowed, float beyond, int u, int v)
  {
    const std::size_t i = space.index(u, v);
    const bool is_near =
        distance < LOOK_AHEAD && space.measured_[i] != 0 && !(distance - space.surface_clearance_ >= surface.margin());
    const bool is_beyond = beyond > 0 && !(LOOK_AHEAD - beyond >= unseen.margin());
    if (!is_near && !is_beyond)
      return;
    const bool own = owners.isOfTarget(u, v);
    if (is_near && !own)
      keepWorse(surface, {distance, space.surface_clearance_, ObstacleKind::Surface, -1, space.pointAt(u, v)});
    if (!is_beyond)
      return;
    const float reaches = allowed + beyond;
    const auto farther = [&](const std::vector<float>& limits) { return reaches - limits[i]; };
    const float least = own ? farther(space.allowed_own_) : farther(space.allowed_);
    const float most = own ? least : std::max(least, farther(space.allowed_unknown_));
    if (most <= -LOOK_AHEAD || -most >= unseen.margin())
      return;
    const float by = most == least || owners.isKnown(u, v) ? least : most;
    if (by > -LOOK_AHEAD)
      keepWorse(unseen, {-by, 0, ObstacleKind::Unknown, -1, reaches * space.ray(u, v)});
  }
};

Encounter SeenSpace::nearest(const BodySweep& body, const PixelOwners& owners) const
{
  Search search{*this, body, owners, {}, {}};
  const Window w = windowOf(body.shape.vertices, LOOK_AHEAD);
  for (int v = w.top / BLOCK * BLOCK; v < w.bottom; v += BLOCK)
    for (int u = w.left / BLOCK * BLOCK; u < w.right; u += BLOCK * BLOCK)
    {
      const unsigned blocks =
          mayMeet(body.planes, body.box.max().z(), ray(u, v), step_, LOOK_AHEAD, &block_nearest_[blockOf(u, v)]);
      for (int k = 0; blocks >> k != 0 && u + k * BLOCK < w.right; ++k)
        if (blocks >> k & 1)
          search.block(u + k * BLOCK, v);
    }
  // What was measured explains more than what was not, whose depth along the ray cannot be compared.
  return search.surface.free() && search.unseen.margin() < search.surface.margin() ? search.unseen : search.surface;
}
}  // namespace bin_picking
