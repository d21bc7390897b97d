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
/// Nearest depth per cell of the image plane z = 1.
class DepthCells
{
public:
  DepthCells(const std::vector<Eigen::Vector3f>& points, float cell) : cell_(cell)
  {
    Eigen::Vector2f low = Eigen::Vector2f::Constant(std::numeric_limits<float>::max());
    Eigen::Vector2f high = -low;
    for (const auto& p : points)
    {
      low = low.cwiseMin(p.head<2>() / p.z());
      high = high.cwiseMax(p.head<2>() / p.z());
    }
    low_ = low;
    constexpr float MAX_SIDE = 2048;  // a pose that almost touches the camera must not cost memory
    cell_ = std::max(cell_, (high - low).maxCoeff() / MAX_SIDE);
    width_ = static_cast<int>((high.x() - low.x()) / cell_) + 1;
    const int height = static_cast<int>((high.y() - low.y()) / cell_) + 1;
    depth_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height),
                  std::numeric_limits<float>::max());
    for (const auto& p : points)
    {
      float& depth = depth_[index(p)];
      depth = std::min(depth, p.z());
    }
  }

  float at(const Eigen::Vector3f& p) const { return depth_[index(p)]; }

private:
  std::size_t index(const Eigen::Vector3f& p) const
  {
    const Eigen::Vector2f q = (p.head<2>() / p.z() - low_) / cell_;
    return static_cast<std::size_t>(static_cast<int>(q.y()) * width_ + static_cast<int>(q.x()));
  }

  float cell_;
  Eigen::Vector2f low_;
  int width_ = 1;
  std::vector<float> depth_;
};
}  // namespace

SurfaceIndices visiblePoints(const TrainedModel& model, const Pose& T_camera_object)
{
  const Eigen::Isometry3f T = T_camera_object.cast<float>();
  std::vector<Eigen::Vector3f> points;
  SurfaceIndices indices;
  for (std::size_t i = 0; i < model.surface.size(); ++i)
  {
    const Eigen::Vector3f p = T * model.surface.points[i];
    if (p.z() <= 0 || (T.linear() * model.surface.normals[i]).dot(p) >= 0)
      continue;
    points.push_back(p);
    indices.push_back(static_cast<std::uint32_t>(i));
  }
  if (points.empty())
    return {};
  // Cells wide enough that a closed surface leaves none empty.
  const auto size = static_cast<float>(1.6 * model.parameters.surface_spacing);
  const DepthCells nearest(points, size / static_cast<float>((T_camera_object * model.center).z()));
  SurfaceIndices visible;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Eigen::Vector3f normal = T.linear() * model.surface.normals[indices[i]];
    const float cosine = std::max(0.25f, -normal.dot(points[i]) / points[i].norm());
    // Within a cell a tilted surface spans this much depth by itself.
    const float slope = size * std::sqrt(1 - cosine * cosine) / cosine;
    if (points[i].z() <= nearest.at(points[i]) + 0.5f * size + 1.5f * slope)
      visible.push_back(indices[i]);
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
