// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "voxel_order.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
constexpr int DIGIT_BITS = 11;
constexpr std::size_t DIGITS = std::size_t{1} << DIGIT_BITS;
constexpr float MAX_VOXELS_PER_SIDE = 1 << 24;  // as far as floats count them exactly
constexpr float MAX_VOXELS = 4e18f;             // of the box: 62 bits

/// Without a call of the library, as every processor can.
std::int64_t roundedDown(float value)
{
  const auto toward_zero = static_cast<std::int64_t>(value);
  return toward_zero - static_cast<std::int64_t>(value < static_cast<float>(toward_zero));
}

/// One pass of a radix sort: stable, by one digit of the voxel.
void sortByDigit(const std::vector<VoxelMember>& from, int shift, std::vector<VoxelMember>& to)
{
  const auto digit = [&](const VoxelMember& member) { return (member.voxel >> shift) % DIGITS; };
  std::array<std::uint32_t, DIGITS> next{};
  for (const VoxelMember& member : from)
    ++next[digit(member)];
  std::uint32_t begin = 0;
  for (std::uint32_t& count : next)
  {
    const std::uint32_t end = begin + count;
    count = begin;
    begin = end;
  }
  for (const VoxelMember& member : from)
    to[next[digit(member)]++] = member;
}
}  // namespace

std::vector<VoxelMember> voxelOrder(const std::vector<Eigen::Vector3f>& points, double leaf)
{
  if (points.empty())
    return {};
  const auto scale = static_cast<float>(1.0 / leaf);
  Eigen::Array3f nearest = points.front();
  Eigen::Array3f farthest = nearest;
  for (const Eigen::Vector3f& p : points)
  {
    nearest = nearest.min(p.array());
    farthest = farthest.max(p.array());
  }
  const Eigen::Array3f low = (nearest * scale).floor();
  const Eigen::Array3f voxels = (farthest * scale).floor() - low + 1;
  const float beyond = low.abs().maxCoeff();
  if (!(voxels.maxCoeff() <= MAX_VOXELS_PER_SIDE && voxels.prod() <= MAX_VOXELS && beyond <= MAX_VOXELS))
    throw ParameterError("the points reach over " + std::to_string(static_cast<double>(voxels.maxCoeff()) * leaf) +
                         " m, which at a leaf of " + std::to_string(leaf) +
                         " m is more voxels than can be counted; remove stray points or take a larger leaf");
  const auto columns = static_cast<std::uint64_t>(voxels.x());
  const auto rows = static_cast<std::uint64_t>(voxels.y());
  const std::array<std::int64_t, 3> first = {roundedDown(low.x()), roundedDown(low.y()), roundedDown(low.z())};
  std::vector<VoxelMember> order(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const auto place = [&](int axis) {
      return static_cast<std::uint64_t>(roundedDown(points[i][axis] * scale) - first[static_cast<std::size_t>(axis)]);
    };
    order[i] = {(place(2) * rows + place(1)) * columns + place(0), static_cast<std::uint32_t>(i)};
  }
  std::vector<VoxelMember> sorted(points.size());
  const std::uint64_t last = columns * rows * static_cast<std::uint64_t>(voxels.z()) - 1;
  for (int shift = 0; last >> shift > 0; shift += DIGIT_BITS)
  {
    sortByDigit(order, shift, sorted);
    order.swap(sorted);
  }
  return order;
}
}  // namespace bin_picking
