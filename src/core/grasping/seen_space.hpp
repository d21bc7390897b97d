// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "bin_picking_perception/model/distance_field.hpp"
#include "body_sweep.hpp"

namespace bin_picking
{
/// The pixels of a part: those whose measured point lies on its surface, and gaps that it alone hides. By blocks of
/// eight pixels of a row, a bit for each.
class OwnPixels
{
public:
  OwnPixels() = default;
  /// None yet, of those in a rectangle.
  OwnPixels(int left, int top, int right, int bottom)
      : left_(left / 8), top_(top), width_(std::max(0, (right + 7) / 8 - left_)), height_(std::max(0, bottom - top))
  {
    bits_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0);
  }

  /// In the rectangle.
  void set(int u, int v)
  {
    std::uint8_t& bits = bits_[index(u / 8, v)];
    bits = static_cast<std::uint8_t>(bits | 1u << u % 8);
  }

  bool at(int u, int v) const { return (inBlock(u / 8, v) >> u % 8 & 1) != 0; }

  /// \param block of eight columns, from the picture's left edge
  std::uint8_t inBlock(int block, int v) const
  {
    const bool inside = block >= left_ && block < left_ + width_ && v >= top_ && v < top_ + height_;
    return inside ? bits_[index(block, v)] : std::uint8_t{0};
  }

private:
  std::size_t index(int block, int v) const
  {
    return static_cast<std::size_t>(v - top_) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(block - left_);
  }

  int left_ = 0;  ///< in blocks, as the width
  int top_ = 0;
  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint8_t> bits_;
};

/// What the camera saw: per pixel's ray how far it is free. In the camera's own frame, so that each ray is exact and no
/// shadow is cut by a grid of other axes.
class SeenSpace
{
public:
  SeenSpace(const DepthGrid& measured, const Bin* bin, const ObstacleParameters& parameters);

  /// The rest of the making: steps 0 to STEPS - 1, which may run at once, before nearest() is asked.
  static constexpr std::size_t STEPS = 2;
  void prepare(std::size_t step);

  OwnPixels ownPixels(const DistanceField& field, const Eigen::AlignedBox3f& box_object, const Pose& T_camera_object,
                      float tolerance) const;

  /// The worst of measured points that are not the target's, and of unseen space.
  Encounter nearest(const BodySweep& body, const OwnPixels& target) const;

  /// Calls visit(u, v, point) for each measured point in a rectangle that encloses the hull of some (camera frame).
  template <typename Visit>
  void forEachPoint(const std::vector<Eigen::Vector3f>& hull, const Visit& visit) const
  {
    const Window w = windowOf(hull, 0);
    for (int v = w.top; v < w.bottom; ++v)
      for (int u = w.left; u < w.right; ++u)
        if (measured_[index(u, v)] != 0)
          visit(u, v, pointAt(u, v));
  }

private:
  struct Window
  {
    int left, top, right, bottom;
  };
  /// First and last measured pixel of a row or a column.
  struct Ends
  {
    bool any = false;
    std::size_t first = 0;
    std::size_t last = 0;
  };
  /// Where a body may meet something in a block of pixels, row by row.
  struct Search;

  std::size_t index(int u, int v) const { return static_cast<std::size_t>(v * stride_ + u); }
  Eigen::Vector3f ray(int u, int v) const
  {
    return {(static_cast<float>(u) - cx_) * step_.x(), (static_cast<float>(v) - cy_) * step_.y(), 1.0f};
  }
  Eigen::Vector3f pointAt(int u, int v) const { return depth_[index(u, v)] * ray(u, v); }
  template <typename Points>
  Window windowOf(const Points& points, float margin) const;
  bool mayMeet(const Planes& planes, int u, int v, float nearest) const;
  void extendTo(const DepthGrid& measured, const Bin* bin);
  void bridgeGaps(const DepthGrid& measured, const Bin* bin);
  void bridgeTo(std::size_t next, std::size_t step, Ends& ends);
  void offer(std::size_t pixel, float depth, std::size_t hidden_by);
  std::vector<float> allowedDepth(float entry) const;
  void findBlockMinima();

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
      hidden_by_;                     ///< of a bridged pixel: the measured one at the nearer end of the bridge; or -1
  std::vector<float> allowed_;        ///< how far a body may go along the ray
  std::vector<float> allowed_own_;    ///< the same for pixels of the target
  std::vector<float> block_nearest_;  ///< smallest depth of each block of pixels
  float surface_clearance_ = 0;
  float unseen_entry_ = 0;
  float shadow_entry_ = 0;
};
}  // namespace bin_picking
