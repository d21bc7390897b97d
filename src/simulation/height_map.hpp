// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking::simulation
{
/// Lower and upper surface of a turned part over a grid of columns that spans its bounding rectangle.
struct PartProfile
{
  int columns = 0;           ///< along x
  int rows = 0;              ///< along y
  Eigen::Vector2d origin;    ///< corner of column (0, 0) in the turned part's frame, metres
  std::vector<float> lower;  ///< z; +infinity: the part does not cover the column
  std::vector<float> upper;  ///< z, widened by one column; -infinity: nothing near
};

/// \param cell edge of a column, metres
PartProfile profileOf(const TriangleMesh& part, const Eigen::Quaterniond& rotation, double cell);

/// Top of what lies in the bin, per column. Frame: the bin's (origin in the middle of the floor, z up).
class HeightMap
{
public:
  HeightMap(double length, double width, double cell);

  int columns() const { return columns_; }
  int rows() const { return rows_; }

  /// Lowest z of the part's origin at which nothing penetrates, its profile's corner at (column, row).
  double restHeight(const PartProfile& profile, int column, int row) const;
  /// The part's origin for that corner and height.
  Eigen::Vector3d origin(const PartProfile& profile, int column, int row, double z) const;
  void add(const PartProfile& profile, int column, int row, double z);

private:
  double cell_;
  int columns_;
  int rows_;
  std::vector<float> height_;
};
}  // namespace bin_picking::simulation
