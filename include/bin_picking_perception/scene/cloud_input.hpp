// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>

#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/scene/bin.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"
#include "bin_picking_perception/scene/point_view.hpp"

namespace pcl
{
struct PointXYZ;
template <typename PointT>
class PointCloud;
}  // namespace pcl

namespace bin_picking
{
class Executor;

/// What is taken as a measurement, and the box in which parts are searched. The limits hold in the camera frame; a bin
/// given with the request narrows them further.
struct InputParameters
{
  double x_min = -10;
  double x_max = 10;
  double y_min = -10;
  double y_max = 10;
  double z_min = 0.05;
  double z_max = 10;
  double bin_floor_margin = 0.003;
  double bin_wall_margin = 0.0;
  double max_plausible_depth = 20;
  double max_projection_error = 2;
  int empty_bin_points = 50;
  double empty_bin_wall_margin = 0.006;
  double empty_bin_floor_share = 0.5;

  void visit(ParameterVisitor& v);
};

/// The points of an organized cloud, which is not copied, and the pinhole camera that fits them. NaN, infinity, (0, 0,
/// 0), absurdly large values and what lies behind the camera count as not measured.
/// \throws CloudError Empty, BadLayout, Unorganized, AllInvalid, UnitSuspect (median depth above max_plausible_depth:
/// it
///   looks like millimetres), NoProjection (pixel residual above max_projection_error)
PointView viewOf(const pcl::PointCloud<pcl::PointXYZ>& cloud, const InputParameters& parameters);

/// viewOf(), copied: what is not measured becomes NaN.
DepthGrid makeGrid(const pcl::PointCloud<pcl::PointXYZ>& cloud, const InputParameters& parameters);

/// Invalidates what lies outside the limits and, if a bin is given, outside of its inner box (above floor + margin,
/// also above the rim).
void cropToRegion(DepthGrid& grid, const InputParameters& parameters, const Bin* bin, const Executor& executor);

/// Least squares fit of a pinhole camera to a lattice of the points, without those that miss it. \param error median
/// pixel residual; infinity if the points fix no camera (fewer than three, or in one row, column or ray)
PinholeCamera fitPinholeCamera(const PointView& points, double& error);

/// Reads a PCD file as it is. \throws FileError missing, not PCD, no x/y/z
pcl::PointCloud<pcl::PointXYZ> loadCloud(const std::string& path);

/// loadCloud() and makeGrid().
DepthGrid loadGrid(const std::string& path, const InputParameters& parameters);

/// Writes an organized binary PCD file (x y z float32, metres, NaN). \throws FileError
void saveGrid(const DepthGrid& grid, const std::string& path);
}  // namespace bin_picking
