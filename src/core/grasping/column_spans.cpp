// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "column_tops.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sweep_lanes.hpp"

namespace bin_picking
{
ColumnTops::ColumnTops(const SurfaceBlocks& surface, const Eigen::Vector3f& direction, float around)
{
  across_.row(0) = direction.unitOrthogonal();
  across_.row(1) = direction.cross(across_.row(0).transpose());
  Eigen::AlignedBox2f box;
  float largest = 0;
  for (const SurfaceBlocks::Block& block : surface.blocks())
  {
    box.extend(across_ * block.center);
    largest = std::max(largest, block.radius);
  }
  if (box.isEmpty())
    return;
  const auto margin = static_cast<std::size_t>(std::ceil((largest + around) / CELL)) + 1;
  low_ = box.min().array() - static_cast<float>(margin) * CELL;
  const Eigen::Array2f cells = box.sizes().array() / CELL;
  columns_ = static_cast<std::size_t>(cells.x()) + 2 + 2 * margin;  // one of them for what rounding moves
  rows_ = static_cast<std::size_t>(cells.y()) + 2 + 2 * margin;

  // Entered a margin late, so that the largest of the values from a cell on is that of the cells around.
  const std::size_t window = 2 * margin + 1;
  const Eigen::Vector2f late = Eigen::Vector2f::Constant(static_cast<float>(margin));
  tops_.assign(columns_ * rows_, -std::numeric_limits<float>::infinity());
  for (const SurfaceBlocks::Block& block : surface.blocks())
  {
    float& top = tops_[index((across_ * block.center - low_) / CELL + late)];
    top = std::max(top, direction.dot(block.center) + block.radius);
  }
  raiseToWindow(tops_.data(), tops_.size(), 1, window);
  raiseToWindow(tops_.data(), tops_.size(), columns_, window);
}
}  // namespace bin_picking
