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
constexpr float MAX_VOXELS_PER_SIDE = 4294967040;  // the largest float below 2^32

/// One pass of a radix sort: stable, by one digit of the place along one axis.
void sortByDigit(const std::vector<VoxelMember>& from, std::size_t axis, int shift, std::vector<VoxelMember>& to)
{
  const auto digit = [&](const VoxelMember& member) { return (member.voxel[axis] >> shift) % DIGITS; };
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
  Eigen::Array3f low = (points.front() * scale).array().floor();
  Eigen::Array3f high = low;
  for (const Eigen::Vector3f& p : points)
  {
    const Eigen::Array3f cell = (p * scale).array().floor();
    low = low.min(cell);
    high = high.max(cell);
  }
  const Eigen::Array3f voxels = high - low + 1;
  if (!(voxels.maxCoeff() <= MAX_VOXELS_PER_SIDE))
    throw ParameterError("the points reach over " + std::to_string(static_cast<double>(voxels.maxCoeff()) * leaf) +
                         " m, which at a leaf of " + std::to_string(leaf) +
                         " m is more than four thousand million voxels; remove stray points or take a larger leaf");
  std::vector<VoxelMember> order(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Eigen::Array3f cell = (points[i] * scale).array().floor() - low;
    order[i] = {{static_cast<std::uint32_t>(cell.x()), static_cast<std::uint32_t>(cell.y()),
                 static_cast<std::uint32_t>(cell.z())},
                static_cast<std::uint32_t>(i)};
  }
  std::vector<VoxelMember> sorted(points.size());
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const auto last = static_cast<std::uint64_t>(voxels[static_cast<Eigen::Index>(axis)] - 1);
    for (int shift = 0; last >> shift > 0; shift += DIGIT_BITS)
    {
      sortByDigit(order, axis, shift, sorted);
      order.swap(sorted);
    }
  }
  return order;
}
}  // namespace bin_picking
