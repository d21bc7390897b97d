// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <array>
#include <cmath>

#include "../common/simd.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/scene/cloud_input.hpp"

namespace bin_picking
{
namespace
{
constexpr std::size_t BLOCK = 8192;  // pixels per task

/// A box in a frame of its own: low <= R p + t <= high.
struct Box
{
  std::array<float, 9> rotation{};  ///< row-major
  std::array<float, 3> translation{};
  std::array<float, 3> low{};
  std::array<float, 3> high{};
};

Box cameraBox(const InputParameters& limits)
{
  const auto f = [](double value) { return static_cast<float>(value); };
  Box box;
  box.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  box.low = {f(limits.x_min), f(limits.y_min), f(limits.z_min)};
  box.high = {f(limits.x_max), f(limits.y_max), f(limits.z_max)};
  return box;
}

/// Above the floor and between the walls; a heap may stand out above the rim.
Box binBox(const Bin& bin, const InputParameters& limits)
{
  const Pose T_bin_camera = bin.T_camera_bin.inverse();
  Box box;
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
      box.rotation[static_cast<std::size_t>(3 * row + column)] = static_cast<float>(T_bin_camera.linear()(row, column));
    box.translation[static_cast<std::size_t>(row)] = static_cast<float>(T_bin_camera.translation()[row]);
  }
  const auto x = static_cast<float>(bin.inner_size.x() / 2 - limits.bin_wall_margin);
  const auto y = static_cast<float>(bin.inner_size.y() / 2 - limits.bin_wall_margin);
  box.low = {-x, -y, static_cast<float>(limits.bin_floor_margin)};
  box.high = {x, y, std::numeric_limits<float>::infinity()};
  return box;
}

BIN_PICKING_SIMD void keepWithin(const Box& given, float* x, float* y, float* z, std::size_t count)
{
  const Box box = given;
  const auto& r = box.rotation;
  const auto& t = box.translation;
  for (std::size_t i = 0; i < count; ++i)
  {
    const float a = r[0] * x[i] + r[1] * y[i] + r[2] * z[i] + t[0];
    const float b = r[3] * x[i] + r[4] * y[i] + r[5] * z[i] + t[1];
    const float c = r[6] * x[i] + r[7] * y[i] + r[8] * z[i] + t[2];
    const bool inside = (a >= box.low[0]) & (a <= box.high[0]) & (b >= box.low[1]) & (b <= box.high[1]) &
                        (c >= box.low[2]) & (c <= box.high[2]);
    x[i] = inside ? x[i] : std::numeric_limits<float>::quiet_NaN();
    y[i] = inside ? y[i] : std::numeric_limits<float>::quiet_NaN();
    z[i] = inside ? z[i] : std::numeric_limits<float>::quiet_NaN();
  }
}
}  // namespace

void cropToRegion(DepthGrid& grid, const InputParameters& parameters, const Bin* bin, const Executor& executor)
{
  std::vector<Box> boxes = {cameraBox(parameters)};
  if (bin)
    boxes.push_back(binBox(*bin, parameters));
  executor.forEach((grid.size() + BLOCK - 1) / BLOCK, [&](std::size_t block) {
    const std::size_t begin = block * BLOCK;
    for (const Box& box : boxes)
      keepWithin(box, &grid.x[begin], &grid.y[begin], &grid.z[begin], std::min(BLOCK, grid.size() - begin));
  });
}
}  // namespace bin_picking
