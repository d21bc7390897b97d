// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "surface_blocks.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "sweep_lanes.hpp"

namespace bin_picking
{
namespace
{
// Cells along the longest edge: some dozen points per block of a part with a few thousand.
constexpr float CELLS = 12;
constexpr float PATCH = 0.004f;  // metres

/// The points of each cell of a grid that holds any.
template <typename Visit>
void forEachCell(const std::vector<Eigen::Vector3f>& points, const Eigen::AlignedBox3f& box, float cell,
                 const Visit& visit)
{
  const Eigen::Array3i cells = (box.sizes().array() / cell).cast<int>() + 1;
  const auto row = static_cast<std::size_t>(cells.x());
  const auto layer = row * static_cast<std::size_t>(cells.y());
  const auto cellOf = [&](const Eigen::Vector3f& p) {
    const Eigen::Array3i i = ((p - box.min()).array() / cell).cast<int>();
    return static_cast<std::size_t>(i.z()) * layer + static_cast<std::size_t>(i.y()) * row +
           static_cast<std::size_t>(i.x());
  };
  std::vector<std::size_t> begin(layer * static_cast<std::size_t>(cells.z()) + 1, 0);
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
      visit(&by_cell[begin[i]], begin[i + 1] - begin[i]);
}

Sphere around(const Eigen::Vector3f* points, std::size_t count)
{
  Eigen::AlignedBox3f box;
  for (std::size_t k = 0; k < count; ++k)
    box.extend(points[k]);
  return {box.center(), 0.5f * box.diagonal().norm()};
}
}  // namespace

SurfaceBlocks::SurfaceBlocks(const std::vector<Eigen::Vector3f>& points)
{
  for (const Eigen::Vector3f& p : points)
    box_.extend(p);
  if (points.empty())
    return;
  const float longest = box_.sizes().maxCoeff();
  forEachCell(points, box_, std::max(longest / CELLS, 1e-4f),
              [&](const Eigen::Vector3f* first, std::size_t count) { addBlock(first, count); });
  centers_.fillUp();
  forEachCell(points, box_, std::max(PATCH, longest / 100),
              [&](const Eigen::Vector3f* first, std::size_t count) { patches_.push_back(around(first, count)); });
}

void SurfaceBlocks::addBlock(const Eigen::Vector3f* points, std::size_t count)
{
  const std::size_t begin = points_.x.size();
  for (std::size_t k = 0; k < count; ++k)
    points_.add(points[k]);
  points_.fillUp();
  blocks_.push_back({around(points, count), begin, begin + count});
  centers_.add(blocks_.back().around.center);
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

/// Whether one of the body's faces keeps it apart from the box of all points.
bool SurfaceBlocks::isApart(const Planes& planes, float distance) const
{
  const Eigen::Vector3f middle = box_.center();
  const Eigen::Vector3f half = 0.5f * box_.sizes();
  return std::any_of(planes.begin(), planes.end(), [&](const Eigen::Vector4f& plane) {
    const Eigen::Vector3f normal = plane.head<3>();
    return normal.dot(middle) + plane.w() - normal.cwiseAbs().dot(half) > distance;
  });
}

void SurfaceBlocks::deepest(const Planes& planes, float& limit, Eigen::Vector3f& point) const
{
  if (blocks_.empty() || isApart(planes, limit))
    return;
  constexpr std::size_t AT_ONCE = 8 * BLOCK;  // as many as fit on the stack
  std::array<float, AT_ONCE> of_blocks;
  std::array<float, AT_ONCE> of_points;
  const auto distances = [&](const Coordinates& of, std::size_t begin, std::size_t end, float* result) {
    const std::size_t count = (end - begin + BLOCK - 1) / BLOCK * BLOCK;
    signedDistances(planes, &of.x[begin], &of.y[begin], &of.z[begin], count, result);
  };
  const auto look = [&](std::size_t begin, std::size_t end) {
    distances(points_, begin, end, of_points.data());
    for (std::size_t k = begin; k < end; ++k)
      if (of_points[k - begin] < limit)
      {
        limit = of_points[k - begin];
        point = points_[k];
      }
  };
  for (std::size_t first = 0; first < blocks_.size(); first += AT_ONCE)
  {
    const std::size_t last = std::min(first + AT_ONCE, blocks_.size());
    distances(centers_, first, last, of_blocks.data());
    for (std::size_t b = first; b < last; ++b)
      if (of_blocks[b - first] < limit + blocks_[b].around.radius)
        for (std::size_t k = blocks_[b].begin; k < blocks_[b].end; k += AT_ONCE)
          look(k, std::min(k + AT_ONCE, blocks_[b].end));
  }
}
}  // namespace bin_picking
