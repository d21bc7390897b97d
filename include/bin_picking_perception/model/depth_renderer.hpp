// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/model/mesh.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
/// A z-buffer: what an ideal pinhole camera at the origin sees. Triangles are filled with perspective-correct depth;
/// both sides of a triangle hide what is behind them.
class DepthRenderer
{
public:
  DepthRenderer(int width, int height, const PinholeCamera& camera);

  /// Draws a mesh, keeping the nearest surface per pixel. `label` marks its pixels.
  void draw(const TriangleMesh& mesh, const Pose& T_camera_object, std::int32_t label);

  /// Draws oriented points as discs of the given radius (metres), for models without triangles.
  void draw(const OrientedPoints& points, const Pose& T_camera_object, double radius, std::int32_t label);

  /// x, y, z of the nearest surface per pixel; NaN where nothing was drawn.
  DepthGrid grid() const;

  /// Depth (infinity where nothing was drawn) and label (-1 there) per pixel, row-major.
  const std::vector<float>& depth() const { return depth_; }
  const std::vector<std::int32_t>& labels() const { return labels_; }

  int width() const { return width_; }
  int height() const { return height_; }
  const PinholeCamera& camera() const { return camera_; }

private:
  int width_;
  int height_;
  PinholeCamera camera_;
  std::vector<float> depth_;
  std::vector<std::int32_t> labels_;
};
}  // namespace bin_picking
