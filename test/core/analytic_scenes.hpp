// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "bin_picking_perception/scene/depth_grid.hpp"

/// Surfaces whose points, normals and curvatures are known in closed form, as an ideal camera sees them.
namespace bin_picking::test
{
constexpr double PI = 3.14159265358979323846;
constexpr double MISS = std::numeric_limits<double>::infinity();

/// Depth z at which a ray (s, t, 1) meets a surface; infinity if it does not.
using Surface = std::function<double(const Eigen::Vector3d& ray)>;

/// 320 x 256 pixels at a pitch of 1 mm at a distance of 0.8 m.
inline PinholeCamera testCamera() { return {800, 800, 159.5, 127.5}; }

inline DepthGrid render(const std::vector<Surface>& surfaces, int width = 320, int height = 256,
                        const PinholeCamera& camera = testCamera())
{
  DepthGrid grid = makeGrid(width, height, camera);
  for (int v = 0; v < height; ++v)
  {
    for (int u = 0; u < width; ++u)
    {
      const Eigen::Vector3d ray = camera.backProject(u, v, 1.0);
      double z = MISS;
      for (const auto& surface : surfaces)
        z = std::min(z, surface(ray));
      if (z == MISS)
        continue;
      const auto i = static_cast<std::size_t>(grid.index(u, v));
      grid.x[i] = static_cast<float>(ray.x() * z);
      grid.y[i] = static_cast<float>(ray.y() * z);
      grid.z[i] = static_cast<float>(z);
    }
  }
  return grid;
}

/// Nearest positive root of a z^2 + b z + c = 0 that `accept` admits.
inline double firstRoot(double a, double b, double c, const std::function<bool(double)>& accept)
{
  const double discriminant = b * b - 4 * a * c;
  if (std::abs(a) < 1e-15)
    return b != 0 && -c / b > 0 && accept(-c / b) ? -c / b : MISS;
  if (discriminant < 0)
    return MISS;
  const double root = std::sqrt(discriminant);
  double nearest = MISS;
  for (const double z : {(-b - root) / (2 * a), (-b + root) / (2 * a)})
    if (z > 0 && accept(z))
      nearest = std::min(nearest, z);
  return nearest;
}

inline Surface sphere(const Eigen::Vector3d& centre, double radius)
{
  return [=](const Eigen::Vector3d& ray) {
    return firstRoot(ray.squaredNorm(), -2 * ray.dot(centre), centre.squaredNorm() - radius * radius,
                     [](double) { return true; });
  };
}

/// The far half of a sphere: a bowl open to the camera.
inline Surface bowl(const Eigen::Vector3d& centre, double radius)
{
  return [=](const Eigen::Vector3d& ray) {
    return firstRoot(ray.squaredNorm(), -2 * ray.dot(centre), centre.squaredNorm() - radius * radius,
                     [&](double z) { return z > centre.z(); });
  };
}

/// Open cylinder about an axis through `centre`, of the given length.
inline Surface cylinder(const Eigen::Vector3d& centre, const Eigen::Vector3d& axis, double radius, double length = 1e3)
{
  const Eigen::Vector3d a = axis.normalized();
  return [=](const Eigen::Vector3d& ray) {
    const Eigen::Vector3d across = ray - a * a.dot(ray);
    const Eigen::Vector3d offset = centre - a * a.dot(centre);
    return firstRoot(across.squaredNorm(), -2 * across.dot(offset), offset.squaredNorm() - radius * radius,
                     [&](double z) { return std::abs(a.dot(ray * z - centre)) <= length / 2; });
  };
}

/// Plane through a point; `inside` limits it.
inline Surface plane(
    const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
    const std::function<bool(const Eigen::Vector3d&)>& inside = [](const Eigen::Vector3d&) { return true; })
{
  return [=](const Eigen::Vector3d& ray) {
    const double z = normal.dot(point) / normal.dot(ray);
    return z > 0 && std::isfinite(z) && inside(ray * z) ? z : MISS;
  };
}

/// Rectangle facing the camera, edges along x and y.
inline Surface rectangle(const Eigen::Vector3d& centre, double size_x, double size_y)
{
  return plane(centre, -Eigen::Vector3d::UnitZ(), [=](const Eigen::Vector3d& p) {
    return std::abs(p.x() - centre.x()) <= size_x / 2 && std::abs(p.y() - centre.y()) <= size_y / 2;
  });
}

/// z = depth + kx x^2 / 2 + ky y^2 / 2: seen from the camera, the principal curvatures at the middle are kx and ky
/// (convex > 0, because the outward normal is -z).
inline Surface paraboloid(double depth, double kx, double ky)
{
  return [=](const Eigen::Vector3d& ray) {
    return firstRoot((kx * ray.x() * ray.x() + ky * ray.y() * ray.y()) / 2, -1, depth, [](double) { return true; });
  };
}

/// Standard normal numbers that are the same with every standard library (Box-Muller on the raw generator).
class GaussianNoise
{
public:
  explicit GaussianNoise(std::uint32_t seed) : generator_(seed) {}
  double operator()()
  {
    const double u = (generator_() + 1.0) / 4294967297.0;
    const double v = generator_() / 4294967296.0;
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * PI * v);
  }

private:
  std::mt19937 generator_;
};

/// Moves every point along its ray by noise of the given deviation in depth, metres.
inline void addDepthNoise(DepthGrid& grid, double deviation, std::uint32_t seed)
{
  GaussianNoise noise(seed);
  for (std::size_t i = 0; i < grid.size(); ++i)
  {
    if (std::isnan(grid.z[i]))
      continue;
    const auto scale = static_cast<float>(1 + deviation * noise() / static_cast<double>(grid.z[i]));
    grid.x[i] *= scale;
    grid.y[i] *= scale;
    grid.z[i] *= scale;
  }
}

inline int numValid(const DepthGrid& grid)
{
  int count = 0;
  for (const float z : grid.z)
    count += !std::isnan(z);
  return count;
}

inline double degreesBetween(const Eigen::Vector3f& a, const Eigen::Vector3f& b)
{
  return std::atan2(a.cast<double>().cross(b.cast<double>()).norm(), a.cast<double>().dot(b.cast<double>())) * 180 / PI;
}
}  // namespace bin_picking::test
