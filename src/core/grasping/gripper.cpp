// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/gripper.hpp"

#include <algorithm>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
// An opening that was computed may miss the end of the range by rounding.
constexpr double ROUNDING = 1e-9;  // metres

void checkOpening(const Gripper& gripper, double opening)
{
  if (opening >= gripper.min_opening - ROUNDING && opening <= gripper.max_opening + ROUNDING)
    return;
  std::ostringstream message;
  message << "The gripper \"" << gripper.name << "\" cannot open to " << 1e3 * opening << " mm: its range is "
          << 1e3 * gripper.min_opening << " to " << 1e3 * gripper.max_opening << " mm.";
  throw ParameterError(message.str());
}

/// The rows of a table round an opening, and the share of the second.
template <typename Row>
struct Between
{
  const Row& low;
  const Row& high;
  double share;
};

template <typename Row>
Between<Row> lookUp(const std::vector<Row>& table, double opening)
{
  const auto above = std::find_if(table.begin(), table.end(), [&](const Row& row) { return row.opening >= opening; });
  if (above == table.begin())
    return {table.front(), table.front(), 0};
  if (above == table.end())
    return {table.back(), table.back(), 0};
  const Row& low = *std::prev(above);
  return {low, *above, (opening - low.opening) / (above->opening - low.opening)};
}
}  // namespace

Pose Gripper::T_tool0_tip(double opening) const
{
  checkOpening(*this, opening);
  const auto [low, high, share] = lookUp(tip_heights, opening);
  Pose T = Pose::Identity();
  T.linear() = R_tool0_tip;
  T.translation() << tip_xy, low.height + share * (high.height - low.height);
  return T;
}

Pose Gripper::T_tool0_body(std::size_t body, double opening) const
{
  checkOpening(*this, opening);
  const GripperBody& piece = bodies[body];
  const auto [low, high, share] = lookUp(piece.placements, opening);
  const Eigen::Vector3d offset = low.offset + share * (high.offset - low.offset);
  const double angle = low.angle + share * (high.angle - low.angle);
  return Eigen::Translation3d(offset + piece.pivot) * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()) *
         Eigen::Translation3d(-piece.pivot);
}

ConvexBody Gripper::bodyAt(std::size_t body, double opening) const
{
  return transformed(bodies[body].shape, T_tool0_body(body, opening));
}
}  // namespace bin_picking
