// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/scene/curvature.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"
#include "bin_picking_perception/scene/point_view.hpp"

namespace bin_picking
{
class Executor;
struct ConnectedRuns;

/// From the raw grid to the surface samples that are matched.
struct PreprocessingParameters
{
  double pixels_per_leaf = 3;  // working grid: pixels are merged in blocks until about this many fit in a leaf
  int outlier_window = 2;
  double outlier_min_share = 0.3;
  double outlier_distance = 0.004;
  double max_normal_tilt = 1.4;  // surfaces seen at a flatter angle are not sampled
  bool split_by_normal = true;

  void visit(ParameterVisitor& v);
};

/// Merges blocks of factor x factor pixels into one: the mean of the block's points that lie near the block's median
/// depth (a mixed block keeps its larger surface; points are never averaged across a depth edge). factor 1 copies.
DepthGrid reduceGrid(const PointView& points, int factor, const Executor& executor);

/// Block size that brings the pitch at the median depth to about leaf / pixels_per_leaf; at least 1.
int reductionFactor(const PointView& points, double leaf, const PreprocessingParameters& parameters);

/// Invalidates points with fewer than outlier_min_share of their (2 window + 1)^2 - 1 neighbours within
/// outlier_distance along the ray direction (slope-aware: the limit grows with the local pitch).
void removeOutliers(DepthGrid& grid, const PreprocessingParameters& parameters, const Executor& executor);

/// Unit normals towards the camera, one per pixel, by a plane fit over the neighbours that are connected without a
/// depth edge, within a square of pixels as large as a disc of `radius` (metres) seen from the front; NaN where there
/// is no point or no plane. \param runs the grid's, by the default edge rule
std::vector<Eigen::Vector3f> estimateGridNormals(const DepthGrid& grid, const ConnectedRuns& runs, double radius,
                                                 const Executor& executor);
std::vector<Eigen::Vector3f> estimateGridNormals(const DepthGrid& grid, double radius, const Executor& executor);

/// Standard deviation of the depth noise, metres: robust, from residuals of small quadric fits. 0 if there is no
/// surface.
double estimateDepthNoise(const DepthGrid& grid, const ConnectedRuns& runs);

/// Samples of the scene's surface on the leaf grid.
struct SceneSamples : OrientedPoints
{
  /// Index into the working grid of the nearest measured pixel.
  std::vector<int> pixel;
  /// 1: at least 80 % of the neighbourhood was measured; not cut off by a depth edge or missing data.
  std::vector<std::uint8_t> curvature_complete;
};

/// One point per leaf-sized voxel: the mean of its points, which averages their noise; with split_by_normal up to three
/// where normals within a voxel differ by more than 30 degrees. Order: by pixel.
SceneSamples sampleScene(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& normals, double leaf,
                         const PreprocessingParameters& parameters);

/// Fills samples.curvature (and curvature_complete) from the grid points within `radius` that are connected to the
/// sample without crossing a depth edge and whose normal is within max_normal_angle of the sample's.
void estimateGridCurvature(SceneSamples& samples, const DepthGrid& grid, const ConnectedRuns& runs,
                           const std::vector<Eigen::Vector3f>& normals, CurvatureMeasure measure, double radius,
                           double max_normal_angle, const Executor& executor);
}  // namespace bin_picking
