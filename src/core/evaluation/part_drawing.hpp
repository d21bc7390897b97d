// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/model/mesh.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
/// Brightness of a surface under the light of the pictures, [0, 1]; the light also reaches what is turned away a
/// little.
float shade(const Eigen::Vector3f& normal);

/// The measured depth as gray, near is bright, with a touch of relief: three floats per pixel, 0 ... 255.
cv::Mat shadedDepth(const DepthGrid& grid);

/// The camera of the same picture enlarged.
PinholeCamera enlarged(const PinholeCamera& camera, int scale);

/// A part drawn alone, in the part of the picture that it covers.
struct PartDrawing
{
  cv::Rect window;
  DepthGrid grid;
  std::vector<Eigen::Vector3f> normals;
};

/// \param surface drawn as discs of the given radius if the mesh is empty
PartDrawing drawPart(const TriangleMesh& mesh, const OrientedPoints& surface, double radius,
                     const Pose& T_camera_object, const PinholeCamera& camera, const cv::Size& size);

/// The part's edges in the picture, those of holes too.
std::vector<std::vector<cv::Point>> contours(const PartDrawing& drawing);

/// Calls paint(point in the picture, index into the drawing) for every pixel that the part covers.
template <typename Function>
void forEachPixel(const PartDrawing& drawing, const Function& paint)
{
  for (int v = 0; v < drawing.window.height; ++v)
    for (int u = 0; u < drawing.window.width; ++u)
      if (const int i = drawing.grid.index(u, v); drawing.grid.valid(i))
        paint(cv::Point(u, v) + drawing.window.tl(), static_cast<std::size_t>(i));
}
}  // namespace bin_picking
