// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "../common/simd.hpp"
#include "bin_picking_perception/refinement/verification.hpp"
#include "moved_points.hpp"

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
  float towards;  ///< part of the vector to the camera along the normal
};

/// Parts of the vectors to the camera along the normals.
/// \param points, normals coordinates, one after the other, of `count` \param camera where it is, part frame
BIN_PICKING_SIMD void towardsCamera(const float* points, const float* normals, std::size_t count,
                                    const std::array<float, 3>& camera, DistanceField::Numbers& along)
{
  const std::array<float, 3> c = camera;
  for (std::size_t k = 0; k < count; ++k)
    along[k] = normals[3 * k] * (c[0] - points[3 * k]) + normals[3 * k + 1] * (c[1] - points[3 * k + 1]) +
               normals[3 * k + 2] * (c[2] - points[3 * k + 2]);
}

std::vector<Facing> pointsFacing(const OrientedPoints& surface, const Eigen::Isometry3f& T_camera_object)
{
  const Motion motion(T_camera_object);
  const Eigen::Vector3f c = T_camera_object.inverse().translation();
  std::vector<Facing> facing;
  facing.reserve(surface.size() / 2);
  std::array<Facing, DistanceField::BLOCK> kept;
  DistanceField::Places places;
  DistanceField::Numbers along;
  for (std::size_t first = 0; first < surface.size(); first += DistanceField::BLOCK)
  {
    const std::size_t count = std::min(DistanceField::BLOCK, surface.size() - first);
    const float* points = surface.points[first].data();
    movePoints(points, count, motion, places);
    towardsCamera(points, surface.normals[first].data(), count, {c.x(), c.y(), c.z()}, along);
    std::size_t size = 0;
    for (std::size_t k = 0; k < count; ++k)
    {
      const float z = places.z[k];
      // Written in any case, kept if it counts: no branch to be guessed wrong.
      kept[size] = {static_cast<std::uint32_t>(first + k), Eigen::Vector2f(places.x[k], places.y[k]) / z, z, along[k]};
      size += static_cast<std::size_t>((z > 0) & (along[k] > 0));
    }
    facing.insert(facing.end(), kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(size));
  }
  return facing;
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
    constexpr float MAX_SIDE = 2048;  // a pose that almost touches the camera must not cost memory
    const float inverse_cell = 1 / std::max(cell, (high - low).maxCoeff() / MAX_SIDE);
    const int width = static_cast<int>((high.x() - low.x()) * inverse_cell) + 1;
    const int height = static_cast<int>((high.y() - low.y()) * inverse_cell) + 1;
    depth_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                  std::numeric_limits<float>::max());
    cell_of_.reserve(points.size());
    for (const Facing& p : points)
    {
      const Eigen::Vector2f q = (p.place - low) * inverse_cell;
      const int cell_index = static_cast<int>(q.y()) * width + static_cast<int>(q.x());
      cell_of_.push_back(cell_index);
      float& depth = depth_[static_cast<std::size_t>(cell_index)];
      depth = std::min(depth, p.depth);
    }
  }

  /// In the cell of the i-th point.
  float at(std::size_t i) const { return depth_[static_cast<std::size_t>(cell_of_[i])]; }

private:
  std::vector<int> cell_of_;
  std::vector<float> depth_;
};

/// Depth that a tilted surface gains across a cell, in edges of the cell.
float slopeOf(const Facing& point)
{
  // p = depth (x, y, 1)
  const float distance = point.depth * std::sqrt(1 + point.place.squaredNorm());
  const float cosine = std::max(0.25f, point.towards / distance);
  return std::sqrt(1 - cosine * cosine) / cosine;
}
}  // namespace

SurfaceIndices visiblePoints(const TrainedModel& model, const Pose& T_camera_object)
{
  const std::vector<Facing> points = pointsFacing(model.surface, T_camera_object.cast<float>());
  if (points.empty())
    return {};
  // Cells wide enough that a closed surface leaves none empty.
  const auto size = static_cast<float>(1.6 * model.parameters.surface_spacing);
  const DepthCells nearest(points, size / static_cast<float>((T_camera_object * model.center).z()));
  SurfaceIndices visible;
  visible.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    // Within a cell a tilted surface spans some depth by itself; most points lie so near that it need not be asked.
    const float behind = points[i].depth - nearest.at(i) - 0.5f * size;
    if (behind <= 0 || behind <= 1.5f * size * slopeOf(points[i]))
      visible.push_back(points[i].index);
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
