// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "column_spans.hpp"

#include <algorithm>

#include "sweep_lanes.hpp"

namespace bin_picking
{
ColumnSpans::ColumnSpans(const SurfaceBlocks& surface, const Eigen::Vector3f& direction, float most)
{
  across_.row(0) = direction.unitOrthogonal();
  across_.row(1) = direction.cross(across_.row(0).transpose());
  Eigen::AlignedBox2f box;
  for (const Sphere& patch : surface.patches())
  {
    box.extend(across_ * patch.center);
    patch_ = std::max(patch_, patch.radius);
  }
  if (box.isEmpty())
    return;
  const std::size_t margin = 2 * cellsFor(patch_ + most);  // within() looks so far, and is asked from so far
  low_ = box.min().array() - static_cast<float>(margin) * CELL;
  const Eigen::Array2f cells = box.sizes().array() / CELL;
  columns_ = stride_ = static_cast<std::size_t>(cells.x()) + 2 + 2 * margin;  // one of them for what rounding moves
  rows_ = static_cast<std::size_t>(cells.y()) + 2 + 2 * margin;
  ahead_.assign(stride_ * rows_, -std::numeric_limits<float>::infinity());
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
  wide.columns_ -= std::min(margin, columns_);
  for (std::vector<float>* farthest : {&wide.ahead_, &wide.back_})
  {
    raiseToWindow(farthest->data(), farthest->size(), 1, 2 * margin + 1);
    raiseToWindow(farthest->data(), farthest->size(), stride_, 2 * margin + 1);
  }
  return wide;
}
}  // namespace bin_picking
