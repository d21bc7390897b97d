// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/scene/curvature.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bin_picking_perception/common/parallel.hpp"
#include "normal_spread.hpp"
#include "quadric_fit.hpp"
#include "tiled_points.hpp"

namespace bin_picking
{
SurfaceCurvature quadricCurvature(double a, double b, double c, double d, double e)
{
  // r(x, y) = (x, y, z(x, y)): r_x = (1, 0, z_x), r_y = (0, 1, z_y); at the origin z_x = d, z_y = e.
  const double E = 1 + d * d;
  const double F = d * e;
  const double G = 1 + e * e;
  const double norm = std::sqrt(1 + d * d + e * e);  // |r_x x r_y|
  // The frame's z axis is the outward normal, so a convex surface bends away from it: the sign is turned to make it >
  // 0.
  const double L = -2 * a / norm;
  const double M = -b / norm;
  const double N = -2 * c / norm;
  const double det = E * G - F * F;

  SurfaceCurvature curvature;
  curvature.gaussian = (L * N - M * M) / det;                // Equation 3
  curvature.mean = (L * G - 2 * M * F + N * E) / (2 * det);  // Equation 4
  const double root = std::sqrt(std::max(0.0, curvature.mean * curvature.mean - curvature.gaussian));
  curvature.k1 = curvature.mean + root;  // roots of Equation 2
  curvature.k2 = curvature.mean - root;
  return curvature;
}

namespace
{
constexpr std::size_t BUNDLE = 64;

/// The points around queries, and the working memory of one task.
struct Surroundings
{
  const TiledPoints& support;
  float min_cosine;
  double min_neighbours;
  Neighbourhood found = {};
};

double meanCurvature(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, double radius,
                     const Surroundings& around)
{
  const QuadricMoments moments =
      around.support.quadricMoments(point, normal, tangentFrame(normal, radius), around.min_cosine);
  return moments.count() < around.min_neighbours ? std::numeric_limits<double>::quiet_NaN()
                                                 : moments.meanCurvature() / radius;
}

double normalVariation(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, Surroundings& around)
{
  NormalSpread spread(normal);
  around.support.forEachNeighbourhood(point, normal, around.min_cosine, around.found,
                                      [&](const Neighbourhood& found) { spread.add(found, around.min_cosine); });
  return spread.count() < around.min_neighbours ? std::numeric_limits<double>::quiet_NaN() : spread.variation();
}
}  // namespace

std::vector<float> estimateCurvature(const OrientedPoints& queries, const OrientedPoints& support,
                                     CurvatureMeasure measure, double radius, double max_normal_angle,
                                     int min_neighbours, const Executor& executor)
{
  const TiledPoints tiled(support, static_cast<float>(radius));
  const auto min_cosine = static_cast<float>(std::cos(max_normal_angle));
  std::vector<float> curvature(queries.size());
  executor.forEachBundle(queries.size(), BUNDLE, [&](std::size_t begin, std::size_t end) {
    Surroundings around{tiled, min_cosine, static_cast<double>(min_neighbours)};
    for (std::size_t i = begin; i < end; ++i)
      curvature[i] = static_cast<float>(measure == CurvatureMeasure::MeanCurvature
                                            ? meanCurvature(queries.points[i], queries.normals[i], radius, around)
                                            : normalVariation(queries.points[i], queries.normals[i], around));
  });
  return curvature;
}
}  // namespace bin_picking
