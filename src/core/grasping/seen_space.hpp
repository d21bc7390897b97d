// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "bin_picking_perception/common/parallel.hpp"
#include "body_sweep.hpp"
#include "sweep_lanes.hpp"

namespace bin_picking
{
class OwnPixels;
class PixelOwners;

/// What the camera saw: per pixel's ray how far it is free. In the camera's own frame, so that each ray is exact and no
/// shadow is cut by a grid of other axes. Immutable.
class SeenSpace
{
public:
  SeenSpace(const DepthGrid& measured, const Bin* bin, const ObstacleParameters& parameters, const Executor& executor);

  /// The worst of measured points that are not the target's, and of unseen space.
  Encounter nearest(const BodySweep& body, const PixelOwners& owners) const;

  /// The measured pixel that hides what is behind a pixel: itself, or the nearer end of the bridge; -1: none does.
  std::int32_t hiderOf(int u, int v) const
  {
    const std::size_t pixel = index(u, v);
    return measured_[pixel] != 0 ? static_cast<std::int32_t>(pixel) : hidden_by_[pixel];
  }
  /// Column and row.
  std::pair<int, int> pixelOf(std::int32_t index) const { return {index % stride_, index / stride_}; }
  Eigen::Vector3f pointAt(int u, int v) const { return depth_[index(u, v)] * ray(u, v); }

  /// Visits the measured points around the hull of some (camera frame), but for those that are passed over:
  /// visitor.mayMeet(sphere), which encloses the points of a block of pixels, or
  /// visitor.mayMeet(ray, step, depth), which returns a bit for each of BLOCK pixels side by side, and
  /// visitor.meet(point).
  template <typename Visitor>
  void forEachPoint(const std::vector<Eigen::Vector3f>& hull, Visitor& visitor) const
  {
    const Window w = windowOf(hull, 0);
    for (int v = w.top / BLOCK * BLOCK; v < w.bottom; v += BLOCK)
      for (int u = w.left / BLOCK * BLOCK; u < w.right; u += BLOCK)
        if (const Sphere& points = block_points_[blockOf(u, v)]; !(points.radius < 0) && visitor.mayMeet(points))
          forEachPointOf(u, v, visitor);
  }

private:
  friend class OwnPixels;

  static constexpr float FAR_AWAY = 1e4f;    ///< metres: free all along the ray; finite, so that products stay numbers
  static constexpr float MIN_DEPTH = 0.05f;  ///< metres: what is nearer to the camera has no place in the picture

  struct Window
  {
    int left, top, right, bottom;

    bool contains(int u, int v) const { return u >= left && u < right && v >= top && v < bottom; }
  };
  /// First and last measured pixel of a row or a column.
  struct Ends
  {
    bool any = false;
    std::size_t first = 0;
    std::size_t last = 0;
  };
  /// A row or a column of the picture: its first pixel, and from each to the next.
  struct Line
  {
    std::size_t begin;
    std::size_t step;
    std::size_t count;
  };
  /// Where a body may meet something in a block of pixels, row by row.
  struct Search;

  std::size_t index(int u, int v) const { return static_cast<std::size_t>(v * stride_ + u); }
  std::size_t blockOf(int u, int v) const
  {
    return static_cast<std::size_t>(v / BLOCK * (stride_ / BLOCK) + u / BLOCK);
  }
  Eigen::Vector3f ray(int u, int v) const
  {
    return {(static_cast<float>(u) - cx_) * step_.x(), (static_cast<float>(v) - cy_) * step_.y(), 1.0f};
  }
  template <typename Points>
  Window windowOf(const Points& points, float margin) const;
  /// Of the block that begins there.
  template <typename Visitor>
  void forEachPointOf(int u, int top, Visitor& visitor) const
  {
    for (int v = top; v < top + BLOCK; ++v)
    {
      const unsigned may_meet = visitor.mayMeet(ray(u, v), step_.x(), &depth_[index(u, v)]);
      for (int k = 0; may_meet >> k != 0; ++k)
        if ((may_meet >> k & 1) != 0 && measured_[index(u + k, v)] != 0)
          visitor.meet(pointAt(u + k, v));
    }
  }

  void layOut(const DepthGrid& measured, const Bin* bin);
  void copyRow(const DepthGrid& measured, int v);
  void bridgeGaps(const DepthGrid& measured, const Executor& executor);
  void change(Ends& ends, std::size_t pixel, std::size_t step);
  void bridge(std::size_t begin, std::size_t end, std::size_t step);
  void goOnBeyond(const Ends& ends, const Line& line, const std::vector<Ends>& crossing);
  void offer(std::size_t pixel, float depth, std::size_t hidden_by);
  void hideBin(const Bin& bin, const Executor& executor);
  std::vector<float> allowedDepth(float entry, float farthest, const Executor& executor) const;
  std::vector<float> allowedBehindUnknown(const Executor& executor) const;
  float boundBlocks(const Executor& executor);
  Sphere aroundPoints(int u, int v, float nearest, float farthest) const;

  int width_ = 0;  ///< of the picture, extended to where the bin may be
  int height_ = 0;
  int stride_ = 0;  ///< width, filled up to whole blocks; so is the height
  int left_ = 0;    ///< where the measured picture begins in the extended one
  int top_ = 0;
  float fx_ = 0, fy_ = 0, cx_ = 0, cy_ = 0;
  Eigen::Vector2f step_ = Eigen::Vector2f::Zero();  ///< of the rays from pixel to pixel: one by the focal lengths
  std::vector<float> depth_;                        ///< metres along z; bridged where not measured
  std::vector<std::uint8_t> measured_;              ///< 1: a measured point
  std::vector<std::int32_t>
      hidden_by_;                       ///< of a bridged pixel: the measured one at the nearer end of the bridge; or -1
  std::vector<float> allowed_;          ///< how far a body may go along the ray
  std::vector<float> allowed_own_;      ///< the same for pixels of the target
  std::vector<float> allowed_unknown_;  ///< the same for pixels of nothing that is known
  std::vector<float> block_nearest_;    ///< at which depth the first ray of each block of pixels may end
  std::vector<Sphere> block_points_;    ///< around the measured points of each block; radius < 0: none
  float surface_clearance_ = 0;
  float unseen_entry_ = 0;
  float shadow_entry_ = 0;
  float unknown_entry_ = 0;
};
}  // namespace bin_picking
