// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/scene/point_view.hpp"
#include "bin_picking_perception/segmentation/segmentation.hpp"

namespace bin_picking
{
namespace
{
struct DepthRange
{
  double near = 0;
  double far = 0;
};

/// 1st and 99th percentile of a lattice of pixels, so that stray points do not stretch the range.
DepthRange dataRange(const DepthGrid& grid)
{
  constexpr int ABOUT = 10000;
  std::vector<float> depths;
  for (const int i : measuredLattice(grid, ABOUT))
    depths.push_back(grid.z[static_cast<std::size_t>(i)]);
  if (depths.empty())
    return {};
  const auto percentile = [&](std::size_t percent) {
    const auto k = static_cast<std::ptrdiff_t>((depths.size() - 1) * percent / 100);
    std::nth_element(depths.begin(), depths.begin() + k, depths.end());
    return static_cast<double>(depths[static_cast<std::size_t>(k)]);
  };
  return {percentile(1), percentile(99)};
}

/// Depths between the nearest corner of the rim and the furthest corner of the floor.
DepthRange binRange(const Bin& bin)
{
  DepthRange range{std::numeric_limits<double>::infinity(), 0};
  for (const double x : {-0.5, 0.5})
  {
    for (const double y : {-0.5, 0.5})
    {
      const Eigen::Vector3d floor(x * bin.inner_size.x(), y * bin.inner_size.y(), 0);
      const Eigen::Vector3d rim = floor + Eigen::Vector3d(0, 0, bin.inner_size.z());
      range.far = std::max(range.far, (bin.T_camera_bin * floor).z());
      range.near = std::min(range.near, (bin.T_camera_bin * rim).z());
    }
  }
  return range;
}

DepthRange effectiveRange(const DepthGrid& grid, const SegmentationParameters& parameters, const Bin* bin)
{
  const double near = parameters.gray_near;
  const double far = parameters.gray_far;
  if (near > 0 || far > 0)
  {
    if (near < far)
      return {near, far};
    std::ostringstream m;
    m << "gray_near = " << near << " m and gray_far = " << far
      << " m are no depth range; gray_near must be below gray_far. Set both, or both to 0 to take them from the bin or "
         "the "
         "data.";
    throw ParameterError(m.str());
  }
  const DepthRange data = dataRange(grid);
  if (!bin)
    return data;
  const DepthRange whole = binRange(*bin);
  const DepthRange both{std::max(whole.near, data.near), std::min(whole.far, data.far)};
  return both.near < both.far ? both : data;  // all data above the rim: the bin says nothing about it
}
}  // namespace

std::vector<std::uint8_t> depthToGray(const DepthGrid& grid, const SegmentationParameters& parameters, const Bin* bin)
{
  const DepthRange range = effectiveRange(grid, parameters, bin);
  // A scene of one depth is as near as can be.
  const auto scale = static_cast<float>(range.far > range.near ? 254 / (range.far - range.near) : 0);
  const auto near = static_cast<float>(range.near);
  std::vector<std::uint8_t> gray(grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i)
  {
    const float level = std::clamp(255 - scale * (grid.z[i] - near), 1.0f, 255.0f);
    gray[i] = static_cast<std::uint8_t>(std::isnan(grid.z[i]) ? 0 : static_cast<int>(level + 0.5f));
  }
  return gray;
}
}  // namespace bin_picking
