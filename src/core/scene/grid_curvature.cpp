// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "../common/simd.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/scene/curvature.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"
#include "neighbourhood.hpp"
#include "normal_spread.hpp"
#include "quadric_fit.hpp"

namespace bin_picking
{
namespace
{
constexpr std::size_t BLOCK = 64;  // samples per task
constexpr double PI = 3.14159265358979323846;
constexpr double MIN_QUADRIC_POINTS = 12;
constexpr double MIN_VARIATION_POINTS = 5;
/// Share of the area of a disc of the radius that must be measured.
constexpr double MIN_COMPLETE_AREA = 0.8;
/// A pixel on a surface seen almost from the side stands for no more than this many times its frontal area.
constexpr float MAX_FORESHORTENING = 5;

double sum(const std::array<float, Neighbourhood::LANES>& lanes)
{
  double total = 0;
  for (const float lane : lanes)
    total += static_cast<double>(lane);
  return total;
}

/// Area of the surface around a sample: a pixel covers (z stride)^2 / (fx fy |n . ray|), ray = p / z.
BIN_PICKING_SIMD double surfaceArea(const Neighbourhood& found, const Eigen::Vector3f& centre, float pitch_per_depth)
{
  const float x0 = centre.x();
  const float y0 = centre.y();
  const float z0 = centre.z();
  const float side = pitch_per_depth * static_cast<float>(found.stride);
  std::array<float, Neighbourhood::LANES> area{};
  for (std::size_t k = 0; k < found.size; k += Neighbourhood::LANES)
    for (std::size_t l = 0; l < Neighbourhood::LANES; ++l)
    {
      const std::size_t i = k + l;
      const float z = z0 + found.z[i];
      const float along_normal = found.nx[i] * (x0 + found.x[i]) + found.ny[i] * (y0 + found.y[i]) + found.nz[i] * z;
      const float stretch = z / std::abs(along_normal);
      area[l] += found.weight[i] * side * side * z * z * (stretch < MAX_FORESHORTENING ? stretch : MAX_FORESHORTENING);
    }
  return sum(area);
}

double normalVariation(const Neighbourhood& found, const Eigen::Vector3f& normal, float min_cosine)
{
  NormalSpread spread(normal);
  spread.add(found, min_cosine);
  return spread.count() < MIN_VARIATION_POINTS ? std::numeric_limits<double>::quiet_NaN() : spread.variation();
}

double meanCurvature(const Neighbourhood& found, const Eigen::Vector3f& normal, double radius, float min_cosine)
{
  const QuadricMoments moments = quadricMoments(found, tangentFrame(normal, radius), normal, min_cosine);
  return moments.count() < MIN_QUADRIC_POINTS ? std::numeric_limits<double>::quiet_NaN()
                                              : moments.meanCurvature() / radius;
}
}  // namespace

void estimateGridCurvature(SceneSamples& samples, const DepthGrid& grid, const ConnectedRuns& runs,
                           const std::vector<Eigen::Vector3f>& normals, CurvatureMeasure measure, double radius,
                           double max_normal_angle, const Executor& executor)
{
  samples.curvature.assign(samples.size(), std::numeric_limits<float>::quiet_NaN());
  samples.curvature_complete.assign(samples.size(), 0);
  const NeighbourSearch search(grid, normals, runs, radius);
  const auto min_cosine = static_cast<float>(std::cos(max_normal_angle));
  const auto pitch_per_depth = static_cast<float>(grid.pitch(1.0));
  executor.forEach((samples.size() + BLOCK - 1) / BLOCK, [&](std::size_t block) {
    Neighbourhood found;
    for (std::size_t i = block * BLOCK; i < std::min(samples.size(), (block + 1) * BLOCK); ++i)
    {
      const Eigen::Vector3f& normal = samples.normals[i];
      search.find(samples.points[i], samples.pixel[i], found);
      samples.curvature[i] = static_cast<float>(measure == CurvatureMeasure::MeanCurvature
                                                    ? meanCurvature(found, normal, radius, min_cosine)
                                                    : normalVariation(found, normal, min_cosine));
      samples.curvature_complete[i] =
          surfaceArea(found, samples.points[i], pitch_per_depth) >= MIN_COMPLETE_AREA * PI * radius * radius;
    }
  });
}
}  // namespace bin_picking
