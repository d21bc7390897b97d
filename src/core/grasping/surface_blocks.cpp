// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "surface_blocks.hpp"

#include <algorithm>
#include <cmath>

namespace bin_picking
{
namespace
{
// Cells along the longest edge: some dozen points per block of a part with a few thousand.
constexpr float CELLS = 12;

/// Distances of points from a body, as far as they are less than a limit. Neighbours are most often told by the same
/// face: it is asked first.
class Probe
{
public:
  explicit Probe(const Planes& planes) : planes_(planes) {}

  /// The signed distance if it is less than `limit`; else something that is not.
  float distanceBelow(float limit, const Eigen::Vector3f& p)
  {
    float distance = of(told_, p);
    for (std::size_t i = 0; distance < limit && i < planes_.size(); ++i)
    {
      const float other = of(i, p);
      if (other >= limit)
        told_ = i;
      distance = std::max(distance, other);
    }
    return distance;
  }

private:
  float of(std::size_t i, const Eigen::Vector3f& p) const { return planes_[i].head<3>().dot(p) + planes_[i].w(); }

  const Planes& planes_;
  std::size_t told_ = 0;
};
}  // namespace

SurfaceBlocks::SurfaceBlocks(const std::vector<Eigen::Vector3f>& points)
{
  for (const Eigen::Vector3f& p : points)
    box_.extend(p);
  if (points.empty())
    return;
  const float cell = std::max(box_.sizes().maxCoeff() / CELLS, 1e-4f);
  const Eigen::Array3i cells = (box_.sizes().array() / cell).cast<int>() + 1;
  const auto cellOf = [&](const Eigen::Vector3f& p) {
    const Eigen::Array3i i = ((p - box_.min()).array() / cell).cast<int>();
    return static_cast<std::size_t>((i.z() * cells.y() + i.y()) * cells.x() + i.x());
  };
  std::vector<std::size_t> begin(static_cast<std::size_t>(cells.prod()) + 1, 0);
  for (const Eigen::Vector3f& p : points)
    ++begin[cellOf(p) + 1];
  for (std::size_t i = 1; i < begin.size(); ++i)
    begin[i] += begin[i - 1];
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  points_.resize(points.size());
  for (const Eigen::Vector3f& p : points)
    points_[next[cellOf(p)]++] = p;

  for (std::size_t i = 0; i + 1 < begin.size(); ++i)
  {
    if (begin[i] == begin[i + 1])
      continue;
    Eigen::AlignedBox3f box;
    for (std::size_t k = begin[i]; k < begin[i + 1]; ++k)
      box.extend(points_[k]);
    blocks_.push_back({box.center(), 0.5f * box.diagonal().norm(), begin[i], begin[i + 1]});
  }
}

void SurfaceBlocks::deepest(const Planes& planes, float& limit, Eigen::Vector3f& point) const
{
  Probe probe(planes);
  for (const Block& block : blocks_)
  {
    const float farthest = limit + block.radius;
    if (probe.distanceBelow(farthest, block.center) >= farthest)
      continue;
    for (std::size_t k = block.begin; k < block.end; ++k)
    {
      const float distance = probe.distanceBelow(limit, points_[k]);
      if (distance < limit)
      {
        limit = distance;
        point = points_[k];
      }
    }
  }
}
}  // namespace bin_picking
