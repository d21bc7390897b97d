// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "sensor_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bin_picking::simulation
{
namespace
{
constexpr double NEAR = 1e-6;  // metres; what reaches behind the camera has no bounding box in the picture

struct Rectangle
{
  int u_min = 0;
  int u_max = 0;  // inclusive
  int v_min = 0;
  int v_max = 0;
};

/// Pixels that may show the object.
Rectangle boundsOf(const SceneObject& object, const SensorView& view)
{
  const Rectangle everything{0, view.width - 1, 0, view.height - 1};
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (const Eigen::Vector3f& vertex : object.mesh->vertices)
  {
    const Eigen::Vector3d p = object.T_camera_object * vertex.cast<double>();
    if (!(p.z() > NEAR))
      return everything;
    const Eigen::Vector2d pixel = view.camera.project(p);
    low = low.cwiseMin(pixel);
    high = high.cwiseMax(pixel);
  }
  const auto clamped = [](double value, int last) { return static_cast<int>(std::clamp(value, -1.0, last + 1.0)); };
  return {std::max(0, clamped(std::floor(low.x()), view.width)),
          std::min(view.width - 1, clamped(std::ceil(high.x()), view.width)),
          std::max(0, clamped(std::floor(low.y()), view.height)),
          std::min(view.height - 1, clamped(std::ceil(high.y()), view.height))};
}

ObjectView countInRow(const RayScene& scene, const SensorView& view, const DepthGrid& measured, int object,
                      const Rectangle& bounds, int v)
{
  ObjectView counts;
  for (int u = bounds.u_min; u <= bounds.u_max; ++u)
  {
    const std::size_t i = view.index(u, v);
    const bool is_visible = view.labels[i] == object;
    counts.visible_pixels += is_visible ? 1 : 0;
    counts.valid_pixels += is_visible && measured.valid(static_cast<int>(i)) ? 1 : 0;
    // Where no object is seen at all this one is not hidden either.
    if (is_visible || (view.labels[i] >= 0 && scene.meetsAlone(object, view.ray(u, v))))
      ++counts.pixels_alone;
  }
  return counts;
}
}  // namespace

SensorView renderView(const RayScene& scene, const SensorParameters& parameters, const Executor& executor)
{
  SensorView view;
  view.width = parameters.width;
  view.height = parameters.height;
  view.camera = cameraOf(parameters);
  const std::size_t size = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  view.labels.assign(size, -1);
  view.depth.assign(size, std::numeric_limits<float>::quiet_NaN());
  view.normals.assign(size, Eigen::Vector3f::Zero());
  executor.forEach(static_cast<std::size_t>(view.height), [&](std::size_t row) {
    const FlushDenormals flush;
    const int v = static_cast<int>(row);
    for (int u = 0; u < view.width; ++u)
    {
      const RayHit hit = scene.fromCamera(view.ray(u, v));
      if (hit.object < 0)
        continue;
      const std::size_t i = view.index(u, v);
      view.labels[i] = hit.object;
      view.depth[i] = static_cast<float>(hit.depth);
      view.normals[i] = hit.normal.cast<float>();
    }
  });
  return view;
}

std::vector<ObjectView> countPixels(const RayScene& scene, const std::vector<SceneObject>& objects,
                                    const SensorView& view, const DepthGrid& measured, const Executor& executor)
{
  std::vector<Rectangle> bounds;
  bounds.reserve(objects.size());
  for (const SceneObject& object : objects)
    bounds.push_back(boundsOf(object, view));
  std::vector<std::vector<ObjectView>> rows(static_cast<std::size_t>(view.height));
  executor.forEach(rows.size(), [&](std::size_t row) {
    const FlushDenormals flush;
    const int v = static_cast<int>(row);
    rows[row].resize(objects.size());
    for (std::size_t k = 0; k < objects.size(); ++k)
      if (v >= bounds[k].v_min && v <= bounds[k].v_max)
        rows[row][k] = countInRow(scene, view, measured, static_cast<int>(k), bounds[k], v);
  });
  std::vector<ObjectView> views(objects.size());
  for (const auto& row : rows)
    for (std::size_t k = 0; k < views.size(); ++k)
    {
      views[k].pixels_alone += row[k].pixels_alone;
      views[k].visible_pixels += row[k].visible_pixels;
      views[k].valid_pixels += row[k].valid_pixels;
    }
  for (ObjectView& view_of_one : views)
    if (view_of_one.pixels_alone > 0)
      view_of_one.visible_fraction =
          static_cast<double>(view_of_one.visible_pixels) / static_cast<double>(view_of_one.pixels_alone);
  return views;
}
}  // namespace bin_picking::simulation
