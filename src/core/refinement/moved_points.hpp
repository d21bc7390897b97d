// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>

#include "bin_picking_perception/model/distance_field.hpp"

namespace bin_picking
{
/// A rigid motion as plain numbers that a loop can keep in registers; the rotation row by row.
struct Motion
{
  explicit Motion(const Eigen::Isometry3f& T)
  {
    Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(rotation.data()) = T.linear();
    Eigen::Map<Eigen::Vector3f>(translation.data()) = T.translation();
  }

  std::array<float, 9> rotation;
  std::array<float, 3> translation;
};

/// \param points coordinates, one point after the other, of `count`, at most a block; the rest of it stays as it is
void movePoints(const float* points, std::size_t count, const Motion& motion, DistanceField::Places& moved);
}  // namespace bin_picking
