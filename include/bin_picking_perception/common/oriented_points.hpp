// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

namespace bin_picking
{
/// Rigid motion. A variable is named T_target_source and maps points of source into target:
/// p_target = T_target_source * p_source, so that adjacent names cancel.
using Pose = Eigen::Isometry3d;

/// Points on a surface with their outward (model) or camera-facing (scene) unit normals, and, once estimated, the
/// curvature at each point. Flat arrays of equal length; `curvature` is empty until it is estimated and holds NaN where
/// it could not be.
struct OrientedPoints
{
  std::vector<Eigen::Vector3f> points;   ///< metres
  std::vector<Eigen::Vector3f> normals;  ///< unit length
  std::vector<float> curvature;          ///< 1/m for the mean curvature (convex > 0), no unit for the normal variation

  std::size_t size() const { return points.size(); }
  bool empty() const { return points.empty(); }
};

/// The elements at `indices`, in that order.
OrientedPoints select(const OrientedPoints& points, const std::vector<int>& indices);

/// The same points moved by T (curvature is invariant).
OrientedPoints transformed(const OrientedPoints& points, const Pose& T);

/// Diagonal of the axis-aligned bounding box, metres; 0 for no points.
double boundingBoxDiagonal(const std::vector<Eigen::Vector3f>& points);
}  // namespace bin_picking
