// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "../common/rounding.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"

namespace bin_picking
{
namespace
{
constexpr float SPLIT_COSINE = 0.8660254f;  // 30 degrees
constexpr std::size_t MAX_SURFACES = 3;     // per voxel: a corner of a box shows three

/// One surface within a voxel; -1 ends the chain of those of the same voxel.
struct Surface
{
  Eigen::Vector3f point = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  float count = 0;
  int next = -1;
};

/// Open addressing from voxel coordinates to the first surface of the voxel.
class VoxelTable
{
public:
  explicit VoxelTable(std::size_t max_voxels)
  {
    std::size_t capacity = 64;
    while (capacity < 2 * max_voxels)
      capacity *= 2;
    slots_.resize(capacity);
  }

  int& firstSurface(const Eigen::Vector3i& voxel)
  {
    std::size_t k = (static_cast<std::size_t>(voxel.x()) * 73856093u ^ static_cast<std::size_t>(voxel.y()) * 19349663u ^
                     static_cast<std::size_t>(voxel.z()) * 83492791u) &
                    (slots_.size() - 1);
    while (slots_[k].first_surface >= 0 && slots_[k].voxel != voxel)
      k = (k + 1) & (slots_.size() - 1);
    slots_[k].voxel = voxel;
    return slots_[k].first_surface;
  }

private:
  struct Slot
  {
    Eigen::Vector3i voxel = Eigen::Vector3i::Zero();
    int first_surface = -1;
  };
  std::vector<Slot> slots_;
};

class Sampler
{
public:
  Sampler(std::size_t max_points, double leaf, bool split)
      : table_(max_points), scale_(static_cast<float>(1 / leaf)), split_cosine_(split ? SPLIT_COSINE : -2.0f)
  {}

  /// Index of the surface that the point was added to.
  int add(const Eigen::Vector3f& point, const Eigen::Vector3f& normal)
  {
    const Eigen::Vector3f cell = point * scale_;
    const Eigen::Vector3i voxel(roundedDown(cell.x()), roundedDown(cell.y()), roundedDown(cell.z()));
    if (!last_first_ || voxel != last_voxel_)  // neighbouring pixels mostly fall into one voxel
      last_first_ = &table_.firstSurface(voxel);
    last_voxel_ = voxel;
    int& first = *last_first_;
    const int s = first < 0 ? (first = append()) : choose(first, normal);
    Surface& surface = surfaces_[static_cast<std::size_t>(s)];
    surface.point += point;
    surface.normal += normal;
    surface.count += 1;
    return s;
  }

  const std::vector<Surface>& surfaces() const { return surfaces_; }

private:
  int append()
  {
    surfaces_.emplace_back();
    return static_cast<int>(surfaces_.size()) - 1;
  }

  /// The first surface that faces the same way; else a new one; the best of the voxel's when it is full. Most pixels
  /// face as the first surface does, which is told without a root.
  int choose(int first, const Eigen::Vector3f& normal)
  {
    const Eigen::Vector3f& sum = surfaces_[static_cast<std::size_t>(first)].normal;
    const float along = sum.dot(normal);
    if (along > 0 && along * along >= split_cosine_ * split_cosine_ * sum.squaredNorm())
      return first;
    int best = first;
    int last = first;
    float best_cosine = -2;
    std::size_t count = 0;
    for (int s = first; s >= 0; s = surfaces_[static_cast<std::size_t>(s)].next, ++count)
    {
      const Eigen::Vector3f& mean = surfaces_[static_cast<std::size_t>(s)].normal;
      const float cosine = mean.dot(normal) / std::max(mean.norm(), 1e-6f);
      if (cosine >= split_cosine_)
        return s;
      if (cosine > best_cosine)
      {
        best_cosine = cosine;
        best = s;
      }
      last = s;
    }
    if (count >= MAX_SURFACES)
      return best;
    const int added = append();
    surfaces_[static_cast<std::size_t>(last)].next = added;
    return added;
  }

  VoxelTable table_;
  Eigen::Vector3i last_voxel_ = Eigen::Vector3i::Zero();
  int* last_first_ = nullptr;
  std::vector<Surface> surfaces_;
  float scale_;
  float split_cosine_;
};

/// Per pixel the surface that it belongs to, -1 for none.
std::vector<int> assignPixels(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& normals, double max_tilt,
                              Sampler& sampler)
{
  const auto min_cosine = static_cast<float>(std::cos(max_tilt));
  std::vector<int> surface_of(grid.size(), -1);
  for (std::size_t i = 0; i < grid.size(); ++i)
  {
    const Eigen::Vector3f& normal = normals[i];
    if (std::isnan(grid.z[i]) || std::isnan(normal.x()))
      continue;
    const Eigen::Vector3f point = grid.point(static_cast<int>(i));
    if (-normal.dot(point) >= min_cosine * point.norm())
      surface_of[i] = sampler.add(point, normal);
  }
  return surface_of;
}

/// Per surface the pixel nearest to its centroid, the first of several.
std::vector<int> nearestPixels(const DepthGrid& grid, const std::vector<int>& surface_of,
                               const std::vector<Surface>& surfaces)
{
  std::vector<int> nearest(surfaces.size(), -1);
  std::vector<float> best(surfaces.size(), std::numeric_limits<float>::infinity());
  std::vector<Eigen::Vector3f> centroids(surfaces.size());
  std::transform(surfaces.begin(), surfaces.end(), centroids.begin(),
                 [](const Surface& surface) { return surface.point / surface.count; });
  for (std::size_t i = 0; i < surface_of.size(); ++i)
  {
    if (surface_of[i] < 0)
      continue;
    const auto s = static_cast<std::size_t>(surface_of[i]);
    const float distance = (grid.point(static_cast<int>(i)) - centroids[s]).squaredNorm();
    if (distance < best[s])
    {
      best[s] = distance;
      nearest[s] = static_cast<int>(i);
    }
  }
  return nearest;
}
}  // namespace

SceneSamples sampleScene(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& normals, double leaf,
                         const PreprocessingParameters& parameters)
{
  const auto num_valid =
      static_cast<std::size_t>(std::count_if(grid.z.begin(), grid.z.end(), [](float z) { return !std::isnan(z); }));
  Sampler sampler(num_valid, leaf, parameters.split_by_normal);
  const std::vector<int> surface_of = assignPixels(grid, normals, parameters.max_normal_tilt, sampler);
  const std::vector<Surface>& surfaces = sampler.surfaces();
  const std::vector<int> nearest = nearestPixels(grid, surface_of, surfaces);

  SceneSamples samples;
  for (auto* vectors : {&samples.points, &samples.normals})
    vectors->reserve(surfaces.size());
  samples.pixel.reserve(surfaces.size());
  for (std::size_t i = 0; i < surface_of.size(); ++i)
  {
    if (surface_of[i] < 0 || nearest[static_cast<std::size_t>(surface_of[i])] != static_cast<int>(i))
      continue;
    const Surface& surface = surfaces[static_cast<std::size_t>(surface_of[i])];
    samples.points.push_back(surface.point / surface.count);
    samples.normals.push_back(surface.normal.normalized());
    samples.pixel.push_back(static_cast<int>(i));
  }
  return samples;
}
}  // namespace bin_picking
