// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking::simulation
{
/// Tells whether points lie inside a closed mesh: counts how often the way along x to infinity leaves it. Metres, part
/// frame. Points on the surface may count as either. The mesh must outlive it.
class SolidTest
{
public:
  explicit SolidTest(const TriangleMesh& mesh);

  bool operator()(const Eigen::Vector3d& point) const;

  /// Where the line parallel to x at these y and z crosses the surface, ascending.
  std::vector<double> crossings(double y, double z) const;

private:
  int row(double y) const;

  const TriangleMesh& mesh_;
  double low_ = 0;
  double step_ = 1;
  std::vector<std::vector<std::uint32_t>> rows_;  ///< triangles that reach into each interval of y
};
}  // namespace bin_picking::simulation
