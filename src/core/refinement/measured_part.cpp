// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "../common/simd.hpp"
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
      : half_size((model.size / 2).cast<float>().array() + model.field.band())
  {
    const Pose T_object_camera = T_camera_object.inverse();
    rotation = T_object_camera.linear().cast<float>();
    offset = (T_object_camera.translation() - model.center).cast<float>();
  }

  bool holds(const Eigen::Vector3f& p) const
  {
    return ((rotation * p + offset).cwiseAbs() - half_size).maxCoeff() <= 0;
  }

  Eigen::Matrix<float, 3, 3, Eigen::RowMajor> rotation;  ///< into the part's frame
  Eigen::Vector3f offset;                                ///< of the box's middle
  Eigen::Vector3f half_size;
};

/// Marks which of every step-th of some pixels of a row lie in the box; those that were not measured do not.
BIN_PICKING_SIMD void markInside(const float* x, const float* y, const float* z, int count, int step,
                                 const PartBox& box, std::uint8_t* inside)
{
  float r[9];
  float o[3];
  float h[3];
  std::copy_n(box.rotation.data(), 9, r);
  std::copy_n(box.offset.data(), 3, o);
  std::copy_n(box.half_size.data(), 3, h);
  for (int k = 0; k < count; ++k)
  {
    const int i = k * step;
    const float px = std::abs(r[0] * x[i] + r[1] * y[i] + r[2] * z[i] + o[0]);
    const float py = std::abs(r[3] * x[i] + r[4] * y[i] + r[5] * z[i] + o[1]);
    const float pz = std::abs(r[6] * x[i] + r[7] * y[i] + r[8] * z[i] + o[2]);
    inside[k] = static_cast<std::uint8_t>((px <= h[0]) & (py <= h[1]) & (pz <= h[2]));
  }
}

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
  const int count = (window.u_end - window.u_begin + window.step - 1) / window.step;
  if (count <= 0)
    return surface;
  std::vector<std::uint8_t> inside(static_cast<std::size_t>(count));
  for (int v = window.v_begin; v < window.v_end; v += window.step)
  {
    const auto first = static_cast<std::size_t>(grid.index(window.u_begin, v));
    markInside(grid.x.data() + first, grid.y.data() + first, grid.z.data() + first, count, window.step, box,
               inside.data());
    for (int k = 0; k < count; ++k)
    {
      if (inside[static_cast<std::size_t>(k)] == 0)
        continue;
      const std::size_t i = first + static_cast<std::size_t>(k * window.step);
      if (std::isnan(normals[i].x()))
        continue;
      surface.points.push_back(grid.point(static_cast<int>(i)));
      surface.normals.push_back(normals[i]);
    }
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
