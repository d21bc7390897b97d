// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "triangle_polytope.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace bin_picking::simulation
{
namespace
{
// Directions that are closer to parallel than this have no cross product to speak of. To leave one out does no harm:
// then a face normal parts them as well.
constexpr double MIN_CROSS_PRODUCT = 1e-9;

// Slower than this along an axis, per unit of time, counts as standing still on it, metres.
constexpr double MIN_SPEED = 1e-12;

struct Range
{
  double low;
  double high;
};

template <typename Points>
Range project(const Points& points, const Eigen::Vector3d& axis)
{
  Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Eigen::Vector3d& p : points)
  {
    const double along = axis.dot(p);
    range.low = std::min(range.low, along);
    range.high = std::max(range.high, along);
  }
  return range;
}

/// Cuts the span to the times at which the two overlap on the axis, a unit vector. \return whether any time is left
bool cutToAxis(TimeSpan& span, const ConvexBody& body, const Eigen::Vector3d& motion, const Triangle& triangle,
               const Eigen::Vector3d& axis, double depth)
{
  const Range moving = project(body.vertices, axis);
  const Range fixed = project(triangle, axis);
  const double to_first_touch = fixed.low + depth - moving.high;  // along the axis
  const double to_last_touch = fixed.high - depth - moving.low;
  const double speed = axis.dot(motion);
  if (std::abs(speed) < MIN_SPEED)
    return to_first_touch < 0 && to_last_touch > 0;
  const auto [begin, end] = std::minmax(to_first_touch / speed, to_last_touch / speed);
  if (to_first_touch > to_last_touch)  // both are too thin along this axis
    return false;
  span.begin = std::max(span.begin, begin);
  span.end = std::min(span.end, end);
  return !span.empty();
}
}  // namespace

TimeSpan overlapTimes(const ConvexBody& body, const Eigen::Vector3d& motion, const Triangle& triangle,
                      const TimeSpan& within, double depth)
{
  constexpr TimeSpan NEVER{0, 0};
  TimeSpan span = within;
  for (const Eigen::Vector4d& plane : body.planes)
    if (!cutToAxis(span, body, motion, triangle, plane.head<3>(), depth))
      return NEVER;
  const Triangle sides = {triangle[1] - triangle[0], triangle[2] - triangle[1], triangle[0] - triangle[2]};
  const Eigen::Vector3d normal = sides[0].cross(sides[1]);
  if (normal.norm() > 0 && !cutToAxis(span, body, motion, triangle, normal.normalized(), depth))
    return NEVER;
  for (const Eigen::Vector3d& side : sides)
  {
    const Eigen::Vector3d direction = side.normalized();
    for (const Eigen::Vector3d& edge : body.edges)
    {
      const Eigen::Vector3d cross = edge.cross(direction);
      const double length = cross.norm();
      if (length > MIN_CROSS_PRODUCT && !cutToAxis(span, body, motion, triangle, cross / length, depth))
        return NEVER;
    }
  }
  return span;
}

bool overlap(const ConvexBody& body, const Triangle& triangle)
{
  return !overlapTimes(body, Eigen::Vector3d::Zero(), triangle).empty();
}
}  // namespace bin_picking::simulation
