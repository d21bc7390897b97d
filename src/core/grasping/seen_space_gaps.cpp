// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// What the camera did not measure: bridged, or hidden in the bin.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "seen_space.hpp"

namespace bin_picking
{
namespace
{
/// Where the ray enters the inside of the bin, through its rim or behind a wall that hides it; 0 if the camera is in
/// there, `beside` if the ray passes by.
float depthAtRim(const Bin& bin, const Pose& T_bin_camera, float beside, const Eigen::Vector3d& ray)
{
  const Eigen::Array3d direction = T_bin_camera.linear() * ray;
  const Eigen::Array3d camera = T_bin_camera.translation();
  const Eigen::Array3d half = bin.inner_size.array() * Eigen::Array3d(0.5, 0.5, 1);
  const Eigen::Array3d low = half * Eigen::Array3d(-1, -1, 0);
  double enters = 0;
  double leaves = static_cast<double>(beside);
  for (int axis = 0; axis < 3; ++axis)
  {
    // A ray along the faces is between them all the time or never: the infinite quotients say so.
    const double a = (low[axis] - camera[axis]) / direction[axis];
    const double b = (half[axis] - camera[axis]) / direction[axis];
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  }
  return enters <= leaves ? static_cast<float>(enters) : beside;
}

constexpr std::size_t BUNDLE = 64;  // lines that one thread works on

template <typename Task>
void forEachLine(std::size_t count, const Executor& executor, const Task& task)
{
  executor.forEachBundle(count, BUNDLE, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i)
      task(i);
  });
}

/// Calls visit(k) for each k < count with a[k] != b[k]; there are few.
template <typename Visit>
void forEachDifference(const std::uint8_t* a, const std::uint8_t* b, std::size_t count, const Visit& visit)
{
  using AtOnce = std::uint64_t;
  const auto areEqual = [&](std::size_t k) {
    AtOnce of_a;
    AtOnce of_b;
    std::memcpy(&of_a, a + k, sizeof(of_a));
    std::memcpy(&of_b, b + k, sizeof(of_b));
    return of_a == of_b;
  };
  for (std::size_t k = 0; k < count; k += sizeof(AtOnce))
  {
    const std::size_t end = std::min(k + sizeof(AtOnce), count);
    if (end - k == sizeof(AtOnce) && areEqual(k))
      continue;
    for (std::size_t i = k; i < end; ++i)
      if (a[i] != b[i])
        visit(i);
  }
}
}  // namespace

void SeenSpace::copyRow(const DepthGrid& measured, int v)
{
  const float* z = &measured.z[static_cast<std::size_t>(measured.index(0, v))];
  float* depth = &depth_[index(left_, top_ + v)];
  std::uint8_t* known = &measured_[index(left_, top_ + v)];
  for (int u = 0; u < measured.width; ++u)
  {
    known[u] = std::isnan(z[u]) ? std::uint8_t{0} : std::uint8_t{1};
    depth[u] = std::isnan(z[u]) ? FAR_AWAY : z[u];
  }
}

/// Along rows and columns; where both bridge, the nearer counts.
void SeenSpace::bridgeGaps(const DepthGrid& measured, const Executor& executor)
{
  const auto width = static_cast<std::size_t>(measured.width);
  const auto height = static_cast<std::size_t>(measured.height);
  const auto stride = static_cast<std::size_t>(stride_);
  if (width == 0 || height == 0)
    return;
  const auto row = [&](std::size_t v) { return Line{index(left_, top_ + static_cast<int>(v)), 1, width}; };
  const auto column = [&](std::size_t u) { return Line{index(left_ + static_cast<int>(u), top_), stride, height}; };
  std::vector<Ends> rows(height);
  std::vector<Ends> columns(width);
  forEachLine(height, executor, [&](std::size_t v) {
    copyRow(measured, static_cast<int>(v));
    const std::size_t begin = row(v).begin;
    if (measured_[begin] != 0)
      change(rows[v], begin, 1);
    forEachDifference(&measured_[begin + 1], &measured_[begin], width - 1,
                      [&](std::size_t k) { change(rows[v], begin + 1 + k, 1); });
    if (measured_[begin + width - 1] != 0)
      rows[v].last = begin + width - 1;
  });
  executor.forEachBundle(width, BUNDLE, [&](std::size_t first, std::size_t end) {
    for (std::size_t u = first; u < end; ++u)
      if (measured_[row(0).begin + u] != 0)
        change(columns[u], row(0).begin + u, stride);
    for (std::size_t v = 1; v < height; ++v)
      forEachDifference(&measured_[row(v).begin + first], &measured_[row(v - 1).begin + first], end - first,
                        [&](std::size_t k) { change(columns[first + k], row(v).begin + first + k, stride); });
    for (std::size_t u = first; u < end; ++u)
      if (measured_[row(height - 1).begin + u] != 0)
        columns[u].last = row(height - 1).begin + u;
  });
  forEachLine(height, executor, [&](std::size_t v) { goOnBeyond(rows[v], row(v), columns); });
  forEachLine(width, executor, [&](std::size_t u) { goOnBeyond(columns[u], column(u), rows); });
}

/// At the first pixel of a line, or where it changes between measured and not.
void SeenSpace::change(Ends& ends, std::size_t pixel, std::size_t step)
{
  if (measured_[pixel] == 0)
    ends.last = pixel - step;
  else if (ends.any)
    bridge(ends.last, pixel, step);
  else
    ends = {true, pixel, pixel};
}

/// A straight line between two measured pixels.
void SeenSpace::bridge(std::size_t begin, std::size_t end, std::size_t step)
{
  const std::size_t count = (end - begin) / step;
  const float a = depth_[begin];
  const float b = depth_[end];
  for (std::size_t k = 1; k < count; ++k)
  {
    // Along a straight line in space the inverse of the depth is linear in the picture.
    const float share = static_cast<float>(k) / static_cast<float>(count);
    offer(begin + k * step, a * b / (b + share * (a - b)), a < b ? begin : end);
  }
}

/// Before the first measured pixel of a row or column, and after the last, its depth goes on where nothing bridges.
/// \param crossing what crosses the line, pixel by pixel
void SeenSpace::goOnBeyond(const Ends& ends, const Line& line, const std::vector<Ends>& crossing)
{
  if (!ends.any)
    return;
  const auto goOn = [&](std::size_t k, std::size_t from) {
    const std::size_t i = line.begin + k * line.step;
    if (!crossing[k].any || i < crossing[k].first || i > crossing[k].last)
      offer(i, depth_[from], from);
  };
  for (std::size_t k = 0; k < (ends.first - line.begin) / line.step; ++k)
    goOn(k, ends.first);
  for (std::size_t k = (ends.last - line.begin) / line.step + 1; k < line.count; ++k)
    goOn(k, ends.last);
}

/// The inside of the bin is unknown where the picture does not show it.
void SeenSpace::hideBin(const Bin& bin, const Executor& executor)
{
  const Pose T_bin_camera = bin.T_camera_bin.inverse();
  forEachLine(static_cast<std::size_t>(height_), executor, [&](std::size_t row) {
    const auto v = static_cast<int>(row);
    for (int u = 0; u < width_; ++u)
      if (depth_[index(u, v)] == FAR_AWAY)
        depth_[index(u, v)] = depthAtRim(bin, T_bin_camera, FAR_AWAY, ray(u, v).cast<double>());
  });
}

/// The nearer of what is said of a pixel remains.
void SeenSpace::offer(std::size_t pixel, float depth, std::size_t hidden_by)
{
  if (depth >= depth_[pixel])
    return;
  depth_[pixel] = depth;
  hidden_by_[pixel] = static_cast<std::int32_t>(hidden_by);
}
}  // namespace bin_picking
