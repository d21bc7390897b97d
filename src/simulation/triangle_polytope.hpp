// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>

#include "bin_picking_perception/grasping/convex_body.hpp"

namespace bin_picking::simulation
{
using Triangle = std::array<Eigen::Vector3d, 3>;

/// From begin to end; empty where begin is not before end.
struct TimeSpan
{
  double begin = -std::numeric_limits<double>::infinity();
  double end = std::numeric_limits<double>::infinity();

  bool empty() const { return !(begin < end); }
};

/// Bodies that share no more than this are taken to touch and not to overlap: ten rounding errors of a float at 1 m.
constexpr double TOUCH = 1e-6;  // metres

/// The times t at which a convex body, moved straight to `body + t * motion`, and a triangle that stands still reach
/// into each other by more than `depth`. By separating axes: at any time two convex bodies are apart if and only if one
/// of the face normals or one of the cross products of their edges parts them; under a straight motion each axis lets
/// them overlap during one span of time, and they truly do during the intersection of all. Exact for the whole way at
/// once: nothing is jumped over, however thin. Without motion: always or never.
/// \param within the times that matter; the result is cut to them, and the search ends early outside
/// \param depth metres that the body has to be moved, in any direction, until they only touch
TimeSpan overlapTimes(const ConvexBody& body, const Eigen::Vector3d& motion, const Triangle& triangle,
                      const TimeSpan& within = {}, double depth = TOUCH);

/// Whether they reach into each other where they are.
bool overlap(const ConvexBody& body, const Triangle& triangle);
}  // namespace bin_picking::simulation
