// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "bin_picking_perception/model/distance_field.hpp"
#include "body_sweep.hpp"

namespace bin_picking
{
/// The pixels of a part: those whose measured point lies on its surface, and gaps that it alone hides.
struct OwnPixels
{
  int left = 0;
  int top = 0;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> own;  ///< row-major

  bool at(int u, int v) const
  {
    const int x = u - left;
    const int y = v - top;
    return x >= 0 && y >= 0 && x < width && y < height && own[static_cast<std::size_t>(y * width + x)] != 0;
  }

  /// Eight pixels from one on, a bit for each.
  std::uint8_t inRow(int u, int v) const
  {
    if (v < top || v >= top + height || u >= left + width || u + 8 <= left)
      return 0;
    unsigned bits = 0;
    for (int k = 0; k < 8; ++k)
      bits |= at(u + k, v) ? 1u << k : 0u;
    return static_cast<std::uint8_t>(bits);
  }
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

  /// Calls visit(point) for each measured point in a rectangle that encloses the box (camera frame).
  template <typename Visit>
  void forEachPoint(const Eigen::AlignedBox3f& box, const Visit& visit) const
  {
    const Window w = windowOf(box);
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
    return {(static_cast<float>(u) - cx_) / fx_, (static_cast<float>(v) - cy_) / fy_, 1.0f};
  }
  Eigen::Vector3f pointAt(int u, int v) const { return depth_[index(u, v)] * ray(u, v); }
  template <typename Points>
  Window windowOf(const Points& points, float margin) const;
  Window windowOf(const Eigen::AlignedBox3f& box) const;
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
  std::vector<float> depth_;            ///< metres along z; bridged where not measured
  std::vector<std::uint8_t> measured_;  ///< 1: a measured point
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
