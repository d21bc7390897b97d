// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/box_collision.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace bin_picking
{
namespace
{
// Three half edges of either box and half of the motion.
constexpr std::size_t NUM_GENERATORS = 7;

// Directions closer to parallel than this have no usable cross product. Any unit axis yields a true lower bound, so
// that an inaccurate one does no harm; only a vanishing one has to be skipped.
constexpr double MIN_CROSS_PRODUCT = 1e-9;

using Generators = std::array<Eigen::Vector3d, NUM_GENERATORS>;

Generators generators(const OrientedBox& moving, const Eigen::Vector3d& motion, const OrientedBox& fixed)
{
  const Eigen::Matrix3d a = moving.T_frame_box.linear() * moving.half_size.asDiagonal();
  const Eigen::Matrix3d b = fixed.T_frame_box.linear() * fixed.half_size.asDiagonal();
  return {a.col(0), a.col(1), a.col(2), 0.5 * motion, b.col(0), b.col(1), b.col(2)};
}

Eigen::Vector3d directionOf(const Eigen::Vector3d& v)
{
  const double length = v.norm();
  return length > 0 ? Eigen::Vector3d(v / length) : Eigen::Vector3d::Zero();
}
}  // namespace

double sweptBoxClearance(const OrientedBox& moving, const Eigen::Vector3d& motion, const OrientedBox& fixed)
{
  // The Minkowski difference of a swept box and a box is a zonotope: its faces are spanned by pairs of generators,
  // hence the largest separation over the cross products of all pairs is exact wherever a face decides. Without motion
  // these are the fifteen axes known for two boxes.
  const Generators edges = generators(moving, motion, fixed);
  Generators directions;
  std::transform(edges.begin(), edges.end(), directions.begin(), directionOf);
  const Eigen::Vector3d offset = moving.T_frame_box.translation() + 0.5 * motion - fixed.T_frame_box.translation();

  double clearance = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < NUM_GENERATORS; ++i)
    for (std::size_t j = i + 1; j < NUM_GENERATORS; ++j)
    {
      const Eigen::Vector3d cross = directions[i].cross(directions[j]);
      const double length = cross.norm();
      if (length < MIN_CROSS_PRODUCT)
        continue;
      const Eigen::Vector3d axis = cross / length;
      double reach = 0;
      for (const Eigen::Vector3d& edge : edges)
        reach += std::abs(axis.dot(edge));
      clearance = std::max(clearance, std::abs(axis.dot(offset)) - reach);
    }
  return clearance;
}

double boxClearance(const OrientedBox& a, const OrientedBox& b)
{
  return sweptBoxClearance(a, Eigen::Vector3d::Zero(), b);
}
}  // namespace bin_picking
