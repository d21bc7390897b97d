// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "column_spans.hpp"

#include <algorithm>

#include "../common/simd.hpp"

namespace bin_picking
{
namespace
{
constexpr float NOTHING = -std::numeric_limits<float>::infinity();  // ahead and back of an empty column

/// What the loops need, as in ColumnSpans::View and ColumnSpans.
struct Lookup
{
  const float* ahead;
  const float* back;
  int stride;
  float last_column, last_row;
  float distance, length;
};

/// \param x, y, along of points in columns \return a bit for each that comes within the distance of its column's span
inline unsigned meetColumns(const Lookup& lookup, const float* x, const float* y, const float* along)
{
  int cell[BLOCK];
  for (int k = 0; k < BLOCK; ++k)
  {
    float column = x[k] > 0.0f ? x[k] : 0.0f;
    float row = y[k] > 0.0f ? y[k] : 0.0f;
    column = column < lookup.last_column ? column : lookup.last_column;
    row = row < lookup.last_row ? row : lookup.last_row;
    cell[k] = static_cast<int>(row) * lookup.stride + static_cast<int>(column);
  }
  int meets[BLOCK];
  for (int k = 0; k < BLOCK; ++k)
  {
    const float ends = lookup.ahead[cell[k]] + lookup.distance - along[k];
    const float begins = -lookup.back[cell[k]] - lookup.distance - along[k];
    const float from = begins > 0.0f ? begins : 0.0f;
    const float to = ends < lookup.length ? ends : lookup.length;
    meets[k] = from <= to ? 1 << k : 0;
  }
  int bits = 0;
  for (int k = 0; k < BLOCK; ++k)
    bits |= meets[k];
  return static_cast<unsigned>(bits);
}

/// The view of a ray, and how it changes from pixel to pixel.
BIN_PICKING_SIMD unsigned meetPixels(const Lookup* lookup, const float* origin, const float* first, const float* more,
                                     const float* depth)
{
  float x[BLOCK];
  float y[BLOCK];
  float along[BLOCK];
  for (int k = 0; k < BLOCK; ++k)
  {
    const auto step = static_cast<float>(k);
    x[k] = depth[k] * (first[0] + step * more[0]) + origin[0];
    y[k] = depth[k] * (first[1] + step * more[1]) + origin[1];
    along[k] = depth[k] * (first[2] + step * more[2]) + origin[2];
  }
  return meetColumns(*lookup, x, y, along);
}

/// \param turn by columns
BIN_PICKING_SIMD unsigned meetPoints(const Lookup* lookup, const float* origin, const float* turn, const float* px,
                                     const float* py, const float* pz)
{
  float x[BLOCK];
  float y[BLOCK];
  float along[BLOCK];
  for (int k = 0; k < BLOCK; ++k)
  {
    x[k] = turn[0] * px[k] + turn[3] * py[k] + turn[6] * pz[k] + origin[0];
    y[k] = turn[1] * px[k] + turn[4] * py[k] + turn[7] * pz[k] + origin[1];
    along[k] = turn[2] * px[k] + turn[5] * py[k] + turn[8] * pz[k] + origin[2];
  }
  return meetColumns(*lookup, x, y, along);
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

ColumnSpans::View ColumnSpans::seenFrom(const Eigen::Isometry3f& T_object_other) const
{
  View view;
  view.turn << across_ / CELL, direction_.transpose();
  view.origin = view.turn * T_object_other.translation();
  view.turn = view.turn * T_object_other.linear();
  view.origin.head<2>() -= low_ / CELL;
  return view;
}

unsigned ColumnSpans::meetOnWay(const View& from_camera, const Eigen::Vector3f& ray, float step, const float* depth,
                                float distance, float length) const
{
  const Lookup lookup{ahead_.data(), back_.data(), static_cast<int>(stride_), last_.x(), last_.y(), distance, length};
  const Eigen::Vector3f first = from_camera.turn * ray;
  const Eigen::Vector3f more = step * from_camera.turn.col(0);
  return meetPixels(&lookup, from_camera.origin.data(), first.data(), more.data(), depth);
}

unsigned ColumnSpans::meetOnWay(const View& view, const float* x, const float* y, const float* z, float distance,
                                float length) const
{
  const Lookup lookup{ahead_.data(), back_.data(), static_cast<int>(stride_), last_.x(), last_.y(), distance, length};
  return meetPoints(&lookup, view.origin.data(), view.turn.data(), x, y, z);
}
}  // namespace bin_picking
