// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "bin_picking_perception/scene/depth_grid.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"

namespace bin_picking
{
/// Pixels around a sample, coordinate by coordinate, so that sums over them run LANES at a time.
struct Neighbourhood
{
  static constexpr std::size_t LANES = 16;
  static constexpr std::size_t CAPACITY = 32 * LANES;  // twice what the stride aims at, and more
  using Plane = std::array<float, CAPACITY>;

  Plane x, y, z;         ///< relative to the sample
  Plane nx, ny, nz;      ///< normals
  Plane weight;          ///< 1; all planes are 0 from `size` to the next multiple of LANES
  std::size_t size = 0;  ///< pixels found that have a normal
  int stride = 1;        ///< pixels from one to the next
};

/// Oriented points, coordinate by coordinate.
struct PointPlanes
{
  const float *x, *y, *z, *nx, *ny, *nz;
};

/// All planes up to the next multiple of LANES.
void padWithZeros(Neighbourhood& found);

/// Finds what is connected to a pixel within a radius: up and down its column and from there along the rows, every
/// stride-th pixel, as far as there is no depth edge. Strides are such that a fit sees no more points than it needs.
class NeighbourSearch
{
public:
  NeighbourSearch(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& normals, const ConnectedRuns& runs,
                  double radius)
      : grid_(grid), normals_(normals), runs_(runs), radius_(static_cast<float>(radius))
  {}

  void find(const Eigen::Vector3f& centre, int pixel, Neighbourhood& found) const;

private:
  bool addRow(const Eigen::Vector3f& centre, int pixel, Neighbourhood& found) const;
  bool add(const Eigen::Vector3f& centre, int pixel, Neighbourhood& found) const;

  const DepthGrid& grid_;
  const std::vector<Eigen::Vector3f>& normals_;
  const ConnectedRuns& runs_;
  float radius_;
};
}  // namespace bin_picking
