// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/scene/curvature.hpp"

namespace bin_picking
{
class Executor;

/// How a dense surface becomes the points that are matched; the same for models and for whole scans, because features
/// agree only between surfaces that were treated alike.
struct SurfaceResampling
{
  double leaf = 0.003;           ///< voxel edge, metres
  double normal_radius = 0.004;  ///< of the plane fit, metres
  CurvatureMeasure measure = CurvatureMeasure::MeanCurvature;
  double curvature_radius = 0.01;  ///< metres
};

/// One point per voxel of edge `leaf`: the mean of its points, up to three where their normals differ by more than 30
/// degrees (an edge keeps both its faces). Means of fewer than min_points are left out. Order: by voxel.
OrientedPoints voxelDownsample(const OrientedPoints& dense, double leaf, int min_points = 1);

/// Normals by plane fits over `support` within the radius, on the side of the given normals. Neighbours whose normal
/// differs by more than max_normal_angle do not count; where fewer than 5 remain the given normal stays.
std::vector<Eigen::Vector3f> estimateNormals(const OrientedPoints& queries, const OrientedPoints& support,
                                             double radius, double max_normal_angle, const Executor& executor);

/// The downsampled points with normals by plane fits that do not reach around edges.
OrientedPoints resamplePoints(const OrientedPoints& dense, double leaf, double normal_radius, const Executor& executor);

/// Curvature from all of the surface around each point but the far sides of walls. NaN where too little is there.
std::vector<float> allRoundCurvature(const OrientedPoints& points, const OrientedPoints& dense,
                                     CurvatureMeasure measure, double radius, const Executor& executor);

/// Downsampling, normals and curvature of Section 2.1.1.
OrientedPoints resampleSurface(const OrientedPoints& dense, const SurfaceResampling& resampling,
                               const Executor& executor);

/// Neighbours on the far side of a thin wall are turned by more than this (rad); those around a square edge by less.
constexpr double OPPOSITE_WALL_ANGLE = 1.77;
}  // namespace bin_picking
