// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <array>
#include <cmath>

#include "bin_picking_perception/scene/cloud_input.hpp"

namespace bin_picking
{
namespace
{
constexpr int ABOUT_FIT_POINTS = 5000;
constexpr int NUM_REFITS = 4;
/// Residuals above this many medians, and above half a pixel, do not count in the next fit.
constexpr double OUTLIER_MEDIANS = 3;
constexpr double MIN_OUTLIER_PIXELS = 0.5;

struct Ray
{
  double pixel;
  double slope;  ///< x / z or y / z
};

struct Line
{
  double focal = 0;
  double centre = 0;
  bool valid = false;

  double residual(const Ray& ray) const { return std::abs(focal * ray.slope + centre - ray.pixel); }
};

/// Least squares of pixel = focal * slope + centre over the rays whose residual to `previous` is at most `limit`.
Line fitLine(const std::vector<Ray>& rays, const Line& previous, double limit)
{
  double n = 0;
  double s = 0;
  double p = 0;
  for (const Ray& ray : rays)
  {
    if (previous.residual(ray) > limit)
      continue;
    n += 1;
    s += ray.slope;
    p += ray.pixel;
  }
  double ss = 0;
  double sp = 0;
  double pp = 0;
  for (const Ray& ray : rays)
  {
    if (previous.residual(ray) > limit)
      continue;
    ss += (ray.slope - s / n) * (ray.slope - s / n);
    sp += (ray.slope - s / n) * (ray.pixel - p / n);
    pp += (ray.pixel - p / n) * (ray.pixel - p / n);
  }
  // Fewer than three points, one column of pixels, or one ray (slopes equal to the precision of a float) fix no camera.
  Line line;
  if (n < 3 || pp < 0.5 || ss < 1e-12 * n)
    return line;
  line.focal = sp / ss;
  line.centre = p / n - line.focal * s / n;
  line.valid = true;
  return line;
}

double medianResidual(const std::vector<Ray>& rays, const Line& line)
{
  std::vector<double> residuals(rays.size());
  std::transform(rays.begin(), rays.end(), residuals.begin(), [&](const Ray& ray) { return line.residual(ray); });
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end());
  return *middle;
}

/// Stray points (mixed pixels, reflections) pull the first fit; each further one drops those that miss the one before.
Line fitRobustly(const std::vector<Ray>& rays)
{
  Line line = fitLine(rays, Line(), std::numeric_limits<double>::infinity());
  for (int k = 0; line.valid && k < NUM_REFITS; ++k)
  {
    const double limit = std::max(MIN_OUTLIER_PIXELS, OUTLIER_MEDIANS * medianResidual(rays, line));
    if (std::none_of(rays.begin(), rays.end(), [&](const Ray& ray) { return line.residual(ray) > limit; }))
      break;
    const Line refit = fitLine(rays, line, limit);
    if (refit.valid)
      line = refit;
  }
  return line;
}
}  // namespace

PinholeCamera fitPinholeCamera(const PointView& points, double& error)
{
  std::array<std::vector<Ray>, 2> rays;
  for (const int i : measuredLattice(points, ABOUT_FIT_POINTS))
  {
    const Eigen::Vector3d p = points.point(i).cast<double>();
    rays[0].push_back({static_cast<double>(i % points.width), p.x() / p.z()});
    rays[1].push_back({static_cast<double>(i / points.width), p.y() / p.z()});
  }
  const Line horizontal = fitRobustly(rays[0]);
  const Line vertical = fitRobustly(rays[1]);
  error = std::numeric_limits<double>::infinity();
  if (!horizontal.valid || !vertical.valid)
    return PinholeCamera();
  error = std::hypot(medianResidual(rays[0], horizontal), medianResidual(rays[1], vertical));
  return {horizontal.focal, vertical.focal, horizontal.centre, vertical.centre};
}
}  // namespace bin_picking
