// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "column_spans.hpp"

#include <algorithm>

#include "../common/simd.hpp"
#include "sweep_lanes.hpp"

namespace bin_picking
{
namespace
{
constexpr float NOTHING = -std::numeric_limits<float>::infinity();  // ahead and back of an empty column

/// Columns and rows as in ColumnSpans; points are first + k * more by their depth, and origin.
BIN_PICKING_SIMD unsigned meetColumns(const float* ahead, const float* back, int stride, const float* last,
                                      const float* origin, const float* first, const float* more, const float* depth,
                                      float distance, float length)
{
  int cell[BLOCK];
  float along[BLOCK];
  for (int k = 0; k < BLOCK; ++k)
  {
    const auto step = static_cast<float>(k);
    float x = depth[k] * (first[0] + step * more[0]) + origin[0];
    float y = depth[k] * (first[1] + step * more[1]) + origin[1];
    along[k] = depth[k] * (first[2] + step * more[2]) + origin[2];
    x = x > 0.0f ? x : 0.0f;
    y = y > 0.0f ? y : 0.0f;
    x = x < last[0] ? x : last[0];
    y = y < last[1] ? y : last[1];
    cell[k] = static_cast<int>(y) * stride + static_cast<int>(x);
  }
  int meets[BLOCK];
  for (int k = 0; k < BLOCK; ++k)
  {
    const float ends = ahead[cell[k]] + distance - along[k];
    const float begins = -back[cell[k]] - distance - along[k];
    const float from = begins > 0.0f ? begins : 0.0f;
    const float to = ends < length ? ends : length;
    meets[k] = from <= to ? 1 << k : 0;
  }
  int bits = 0;
  for (int k = 0; k < BLOCK; ++k)
    bits |= meets[k];
  return static_cast<unsigned>(bits);
}
}  // namespace

ColumnSpans::ColumnSpans(const SurfaceBlocks& surface, const Eigen::Vector3f& direction, float most)
    : direction_(direction)
{
  across_.row(0) = direction.unitOrthogonal();
  across_.row(1) = direction.cross(across_.row(0).transpose());
  Eigen::AlignedBox2f box;
  for (const Sphere& patch : surface.patches())
  {
    box.extend(across_ * patch.center);
    patch_ = std::max(patch_, patch.radius);
  }
  std::size_t rows = 1;
  if (!box.isEmpty())
  {
    // within() looks so far, and is asked from so far; beyond that, also of what rounding moves, columns stay empty.
    const std::size_t margin = 2 * cellsFor(patch_ + most) + 2;
    low_ = box.min().array() - static_cast<float>(margin) * CELL;
    const Eigen::Array2f cells = box.sizes().array() / CELL;
    stride_ = static_cast<std::size_t>(cells.x()) + 2 + 2 * margin;
    rows = static_cast<std::size_t>(cells.y()) + 2 + 2 * margin;
  }
  last_ = Eigen::Vector2f(static_cast<float>(stride_ - 1), static_cast<float>(rows - 1));
  ahead_.assign(stride_ * rows, NOTHING);
  back_ = ahead_;
  for (const Sphere& patch : surface.patches())
  {
    const std::size_t cell = index((across_ * patch.center - low_) / CELL);
    const float along = direction.dot(patch.center);
    ahead_[cell] = std::max(ahead_[cell], along + patch.radius);
    back_[cell] = std::max(back_[cell], patch.radius - along);
  }
}

ColumnSpans ColumnSpans::within(float distance) const
{
  // A cell takes the largest value from itself on; seen from a margin farther on, that is the largest around.
  const std::size_t margin = cellsFor(patch_ + distance);
  ColumnSpans wide = *this;
  wide.low_.array() += static_cast<float>(margin) * CELL;
  wide.last_.x() = std::max(0.0f, wide.last_.x() - static_cast<float>(margin));  // farther on, rows run into the next
  for (std::vector<float>* farthest : {&wide.ahead_, &wide.back_})
  {
    raiseToWindow(farthest->data(), farthest->size(), 1, 2 * margin + 1);
    raiseToWindow(farthest->data(), farthest->size(), stride_, 2 * margin + 1);
  }
  return wide;
}

ColumnSpans::PixelView ColumnSpans::seenBy(const Eigen::Isometry3f& T_object_camera) const
{
  PixelView view;
  view.turn << across_ / CELL, direction_.transpose();
  view.origin = view.turn * T_object_camera.translation();
  view.turn = view.turn * T_object_camera.linear();
  view.origin.head<2>() -= low_ / CELL;
  return view;
}

unsigned ColumnSpans::meetOnWay(const PixelView& view, const Eigen::Vector3f& ray, float step, const float* depth,
                                float distance, float length) const
{
  const Eigen::Vector3f first = view.turn * ray;
  const Eigen::Vector3f more = step * view.turn.col(0);
  return meetColumns(ahead_.data(), back_.data(), static_cast<int>(stride_), last_.data(), view.origin.data(),
                     first.data(), more.data(), depth, distance, length);
}
}  // namespace bin_picking
