// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/view_templates.hpp"

#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/depth_renderer.hpp"
#include "even_directions.hpp"
#include "view_camera.hpp"

namespace bin_picking
{
namespace
{
constexpr double MIN_FACING_COSINE = 0.1;
constexpr double DEPTH_TOLERANCE_PIXELS = 1.5;
constexpr double DISC_RADIUS_PIXELS = 2;

bool isVisible(const Eigen::Vector3d& p_camera, const Eigen::Vector3d& normal_camera, const DepthRenderer& image,
               double pixel)
{
  const double cosine = -normal_camera.dot(p_camera.normalized());
  if (!(cosine > MIN_FACING_COSINE))
    return false;
  const Eigen::Vector2d uv = image.camera().project(p_camera);
  const auto u = static_cast<int>(std::lround(uv.x()));
  const auto v = static_cast<int>(std::lround(uv.y()));
  const std::size_t i =
      static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width()) + static_cast<std::size_t>(u);
  const double slope = std::sqrt(std::max(0.0, 1 - cosine * cosine)) / cosine;
  return p_camera.z() <= static_cast<double>(image.depth()[i]) + pixel * (DEPTH_TOLERANCE_PIXELS + slope);
}

/// Silhouette sizes, each pixel at the depth of its own surface.
void measureSilhouette(const DepthRenderer& image, ViewTemplate& view)
{
  std::vector<std::uint8_t> mask(image.depth().size(), 0);
  double area = 0;
  double pixel_sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < mask.size(); ++i)
  {
    if (std::isinf(image.depth()[i]))
      continue;
    const double pixel = static_cast<double>(image.depth()[i]) / image.camera().fx;
    mask[i] = 1;
    area += pixel * pixel;
    pixel_sum += pixel;
    ++count;
  }
  view.area = static_cast<float>(area);
  if (count > 0)
    view.contour =
        static_cast<float>(contourLength(mask, image.width(), image.height()) * pixel_sum / static_cast<double>(count));
}

ViewTemplate renderView(const TriangleMesh& mesh, const OrientedPoints& surface, const ViewCamera& camera,
                        const Eigen::Vector3d& direction)
{
  const Pose T_camera_object = camera.poseOfObject(direction);
  DepthRenderer image(camera.side, camera.side, camera.intrinsics);
  if (mesh.empty())
    image.draw(surface, T_camera_object, DISC_RADIUS_PIXELS * camera.pixel, 0);
  else
    image.draw(mesh, T_camera_object, 0);
  ViewTemplate view;
  view.direction = direction.cast<float>();
  measureSilhouette(image, view);
  for (std::size_t i = 0; i < surface.size(); ++i)
    if (isVisible(T_camera_object * surface.points[i].cast<double>(),
                  T_camera_object.linear() * surface.normals[i].cast<double>(), image, camera.pixel))
      view.visible.push_back(static_cast<std::uint32_t>(i));
  return view;
}
}  // namespace

std::vector<ViewTemplate> renderViewTemplates(const TriangleMesh& mesh, const OrientedPoints& surface, double pixel,
                                              int num_views, const Executor& executor)
{
  if (num_views < 1)
    throw ParameterError("the number of views is " + std::to_string(num_views) + ", but at least 1 is needed");
  if (mesh.empty() && surface.empty())
    throw ParameterError("a part without triangles and without points has no views; load its mesh first");
  // Of both: the surface samples may lie a rounding outside the mesh, and must project into the image all the same.
  std::vector<Eigen::Vector3f> outline = mesh.vertices;
  outline.insert(outline.end(), surface.points.begin(), surface.points.end());
  const ViewCamera camera(outline, pixel);
  const std::vector<Eigen::Vector3d> directions = evenDirections(num_views);
  std::vector<ViewTemplate> views(directions.size());
  executor.forEach(directions.size(),
                   [&](std::size_t i) { views[i] = renderView(mesh, surface, camera, directions[i]); });
  return views;
}

std::vector<std::uint8_t> seenByAnyView(const std::vector<ViewTemplate>& views, std::size_t num_surface_points)
{
  std::vector<std::uint8_t> seen(num_surface_points, 0);
  for (const ViewTemplate& view : views)
    for (const std::uint32_t i : view.visible)
      seen.at(i) = 1;
  return seen;
}
}  // namespace bin_picking
