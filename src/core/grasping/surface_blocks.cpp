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
  for (const Block& block : blocks_)
  {
    if (signedDistance(planes, block.center) - block.radius >= limit)
      continue;
    for (std::size_t k = block.begin; k < block.end; ++k)
    {
      const float distance = signedDistance(planes, points_[k]);
      if (distance < limit)
      {
        limit = distance;
        point = points_[k];
      }
    }
  }
}
}  // namespace bin_picking
