// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"

namespace bin_picking
{
class Executor;

/// Which number stands for "curvature" in the pair feature.
enum class CurvatureMeasure
{
  /// H of Equations 1-4, from a local quadric; 1/m; convex seen from outside > 0.
  MeanCurvature,
  /// (pc1 + pc2) / 2, the variance of the neighbours' normals in the tangent plane; no unit, >= 0. The paper's
  /// published steps and ranges fit this value (see docs/paper.md).
  NormalVariation
};

/// First and second fundamental form of z = r(x, y) at one point, and what follows from them (Equations 1-4).
struct SurfaceCurvature
{
  double mean = 0;      ///< H, Equation 4
  double gaussian = 0;  ///< K, Equation 3
  double k1 = 0;        ///< larger root of Equation 2
  double k2 = 0;        ///< smaller root
};

/// Equations 1-4 for the quadric z = a x^2 + b x y + c y^2 + d x + e y + f at the origin, in the frame whose z axis is
/// the outward normal. Signs: a sphere seen from outside has k1 = k2 = +1/R.
SurfaceCurvature quadricCurvature(double a, double b, double c, double d, double e);

/// Curvature at each of `queries`, from the neighbours of `support` within `radius`. Neighbours whose normal is turned
/// by more than `max_normal_angle` from the query's do not count (the other side of a thin wall). NaN where fewer than
/// `min_neighbours` remain. The result does not depend on the executor.
std::vector<float> estimateCurvature(const OrientedPoints& queries, const OrientedPoints& support,
                                     CurvatureMeasure measure, double radius, double max_normal_angle,
                                     int min_neighbours, const Executor& executor);
}  // namespace bin_picking
