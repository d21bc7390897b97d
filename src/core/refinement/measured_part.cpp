// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <cmath>

#include "bin_picking_perception/model/trained_model.hpp"
#include "bin_picking_perception/refinement/icp.hpp"
#include "pixel_window.hpp"

namespace bin_picking
{
namespace
{
/// The part's box at a pose, grown by the band of its distance field.
struct PartBox
{
  PartBox(const TrainedModel& model, const Pose& T_camera_object)
      : T_object_camera(T_camera_object.inverse().cast<float>()),
        center(model.center.cast<float>()),
        half_size((model.size / 2).cast<float>().array() + model.field.band())
  {}

  bool holds(const Eigen::Vector3f& p) const
  {
    return ((T_object_camera * p - center).cwiseAbs() - half_size).maxCoeff() <= 0;
  }

  Eigen::Isometry3f T_object_camera;
  Eigen::Vector3f center;
  Eigen::Vector3f half_size;
};

/// Half a pixel outward of the pixel's middle, with the direction across the ray.
void addEdge(const DepthGrid& grid, int pixel, const Eigen::Vector2f& outward, OrientedPoints& edges)
{
  const Eigen::Vector3f p = grid.point(pixel);
  const Eigen::Vector3f across = acrossRay(p, outward);
  edges.points.push_back(p + 0.5f * static_cast<float>(grid.pitch(static_cast<double>(p.z()))) * across);
  edges.normals.push_back(across);
}
PixelWindow windowOf(const TrainedModel& model, const PartBox& box, const Pose& T_camera_object, const DepthGrid& grid,
                     std::size_t max_pixels)
{
  return {grid, T_camera_object * model.center, static_cast<double>(box.half_size.norm()), max_pixels};
}

OrientedPoints surfaceIn(const PartBox& box, const PixelWindow& window, const DepthGrid& grid,
                         const std::vector<Eigen::Vector3f>& normals)
{
  OrientedPoints surface;
  for (int v = window.v_begin; v < window.v_end; v += window.step)
    for (int u = window.u_begin; u < window.u_end; u += window.step)
    {
      const int i = grid.index(u, v);
      const Eigen::Vector3f& normal = normals[static_cast<std::size_t>(i)];
      if (std::isnan(normal.x()) || !grid.valid(i) || !box.holds(grid.point(i)))
        continue;
      surface.points.push_back(grid.point(i));
      surface.normals.push_back(normal);
    }
  return surface;
}
}  // namespace

OrientedPoints surfaceNear(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid,
                           const std::vector<Eigen::Vector3f>& normals)
{
  const PartBox box(model, T_camera_object);
  return surfaceIn(box, windowOf(model, box, T_camera_object, grid, grid.size()), grid, normals);
}

MeasuredPart measuredNear(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid,
                          const std::vector<Eigen::Vector3f>& normals, const DepthEdges& edges, std::size_t max_pixels)
{
  const PartBox box(model, T_camera_object);
  const PixelWindow window = windowOf(model, box, T_camera_object, grid, max_pixels);
  MeasuredPart measured;
  measured.surface = surfaceIn(box, window, grid, normals);
  for (int v = window.v_begin; v < window.v_end; v += window.step)
    for (const DepthEdge& edge : edges.rows[static_cast<std::size_t>(v)])
      if (edge.column >= window.u_begin && edge.column < window.u_end &&
          box.holds(grid.point(grid.index(edge.column, v))))
        addEdge(grid, grid.index(edge.column, v), edge.outward, measured.edges);
  return measured;
}
}  // namespace bin_picking
