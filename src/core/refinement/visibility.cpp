// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <limits>

#include "bin_picking_perception/refinement/verification.hpp"

namespace bin_picking
{
namespace
{
/// A surface point that faces the camera, at its place in the image plane z = 1.
struct Facing
{
  std::uint32_t index;
  Eigen::Vector2f place;
  float depth;
  float cosine;  ///< between the normal and the ray to the camera
};

std::vector<Facing> pointsFacing(const TrainedModel& model, const Eigen::Isometry3f& T_camera_object)
{
  std::vector<Facing> points;
  points.reserve(model.surface.size() / 2);
  for (std::size_t i = 0; i < model.surface.size(); ++i)
  {
    const Eigen::Vector3f p = T_camera_object * model.surface.points[i];
    const float towards = -(T_camera_object.linear() * model.surface.normals[i]).dot(p);
    if (p.z() > 0 && towards > 0)
      points.push_back({static_cast<std::uint32_t>(i), p.head<2>() / p.z(), p.z(), towards / p.norm()});
  }
  return points;
}

/// Nearest depth per cell of the image plane.
class DepthCells
{
public:
  DepthCells(const std::vector<Facing>& points, float cell)
  {
    Eigen::Vector2f low = Eigen::Vector2f::Constant(std::numeric_limits<float>::max());
    Eigen::Vector2f high = -low;
    for (const Facing& p : points)
    {
      low = low.cwiseMin(p.place);
      high = high.cwiseMax(p.place);
    }
    low_ = low;
    constexpr float MAX_SIDE = 2048;  // a pose that almost touches the camera must not cost memory
    inverse_cell_ = 1 / std::max(cell, (high - low).maxCoeff() / MAX_SIDE);
    width_ = static_cast<int>((high.x() - low.x()) * inverse_cell_) + 1;
    const int height = static_cast<int>((high.y() - low.y()) * inverse_cell_) + 1;
    depth_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height),
                  std::numeric_limits<float>::max());
    for (const Facing& p : points)
    {
      float& depth = depth_[index(p)];
      depth = std::min(depth, p.depth);
    }
  }

  float at(const Facing& p) const { return depth_[index(p)]; }

private:
  std::size_t index(const Facing& p) const
  {
    const Eigen::Vector2f q = (p.place - low_) * inverse_cell_;
    const int cell = static_cast<int>(q.y()) * width_ + static_cast<int>(q.x());
    return static_cast<std::size_t>(cell);
  }

  float inverse_cell_ = 0;
  Eigen::Vector2f low_;
  int width_ = 1;
  std::vector<float> depth_;
};
}  // namespace

SurfaceIndices visiblePoints(const TrainedModel& model, const Pose& T_camera_object)
{
  const std::vector<Facing> points = pointsFacing(model, T_camera_object.cast<float>());
  if (points.empty())
    return {};
  // Cells wide enough that a closed surface leaves none empty.
  const auto size = static_cast<float>(1.6 * model.parameters.surface_spacing);
  const DepthCells nearest(points, size / static_cast<float>((T_camera_object * model.center).z()));
  SurfaceIndices visible;
  visible.reserve(points.size());
  for (const Facing& point : points)
  {
    // Within a cell a tilted surface spans this much depth by itself.
    const float cosine = std::max(0.25f, point.cosine);
    const float slope = size * std::sqrt(1 - cosine * cosine) / cosine;
    if (point.depth <= nearest.at(point) + 0.5f * size + 1.5f * slope)
      visible.push_back(point.index);
  }
  return visible;
}

SurfaceIndices thinned(const SurfaceIndices& points, std::size_t max_points)
{
  const std::size_t step = std::max<std::size_t>(1, (points.size() + max_points - 1) / max_points);
  SurfaceIndices chosen;
  chosen.reserve(points.size() / step + 1);
  for (std::size_t i = 0; i < points.size(); i += step)
    chosen.push_back(points[i]);
  return chosen;
}
}  // namespace bin_picking
