// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "surface_blocks.hpp"

#include <algorithm>
#include <cmath>

#include "sweep_lanes.hpp"

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
  std::vector<Eigen::Vector3f> by_cell(points.size());
  for (const Eigen::Vector3f& p : points)
    by_cell[next[cellOf(p)]++] = p;

  for (std::size_t i = 0; i + 1 < begin.size(); ++i)
    if (begin[i] < begin[i + 1])
      addBlock(&by_cell[begin[i]], begin[i + 1] - begin[i]);
  centers_.fillUp();
}

void SurfaceBlocks::addBlock(const Eigen::Vector3f* points, std::size_t count)
{
  Eigen::AlignedBox3f box;
  const std::size_t begin = points_.x.size();
  for (std::size_t k = 0; k < count; ++k)
  {
    box.extend(points[k]);
    points_.add(points[k]);
  }
  points_.fillUp();
  blocks_.push_back({box.center(), 0.5f * box.diagonal().norm(), begin, begin + count});
  centers_.add(box.center());
}

void SurfaceBlocks::Coordinates::add(const Eigen::Vector3f& p)
{
  x.push_back(p.x());
  y.push_back(p.y());
  z.push_back(p.z());
}

void SurfaceBlocks::Coordinates::fillUp()
{
  while (x.size() % BLOCK != 0)
    add((*this)[x.size() - 1]);
}

void SurfaceBlocks::Coordinates::distancesFrom(const Planes& planes, std::size_t begin, std::size_t end,
                                               std::vector<float>& distances) const
{
  distances.resize((end - begin + BLOCK - 1) / BLOCK * BLOCK);
  signedDistances(planes, &x[begin], &y[begin], &z[begin], distances.size(), distances.data());
}

void SurfaceBlocks::deepest(const Planes& planes, float& limit, Eigen::Vector3f& point) const
{
  if (blocks_.empty())
    return;
  std::vector<float> of_blocks;
  std::vector<float> of_points;
  centers_.distancesFrom(planes, 0, blocks_.size(), of_blocks);
  for (std::size_t b = 0; b < blocks_.size(); ++b)
  {
    const Block& block = blocks_[b];
    if (of_blocks[b] >= limit + block.radius)
      continue;
    points_.distancesFrom(planes, block.begin, block.end, of_points);
    for (std::size_t k = block.begin; k < block.end; ++k)
      if (of_points[k - block.begin] < limit)
      {
        limit = of_points[k - block.begin];
        point = points_[k];
      }
  }
}
}  // namespace bin_picking
