// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cmath>
#include <random>

#include "bin_picking_perception/common/oriented_points.hpp"

namespace bin_picking
{
namespace test
{
/// Uniform in [low, high), the same on every platform (std's distributions are not).
inline double uniform(std::mt19937& random, double low, double high)
{
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

inline Eigen::Vector3d unitVector(std::mt19937& random)
{
  const double z = uniform(random, -1, 1);
  const double angle = uniform(random, 0, 2 * M_PI);
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

/// Any rotation, any translation up to `reach` metres.
inline Pose randomPose(std::mt19937& random, double reach)
{
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisd(uniform(random, 0, M_PI), unitVector(random)).toRotationMatrix();
  T.translation() = reach * uniform(random, 0, 1) * unitVector(random);
  return T;
}

inline void add(OrientedPoints& points, const Eigen::Vector3d& p, const Eigen::Vector3d& n)
{
  points.points.push_back(p.cast<float>());
  points.normals.push_back(n.cast<float>());
}

inline OrientedPoints sphere(double radius, std::size_t count, std::uint32_t seed = 1)
{
  std::mt19937 random(seed);
  OrientedPoints points;
  for (std::size_t i = 0; i < count; ++i)
  {
    const Eigen::Vector3d n = unitVector(random);
    add(points, radius * n, n);
  }
  return points;
}

/// Side of a cylinder about z.
inline OrientedPoints cylinder(double radius, double length, std::size_t count, std::uint32_t seed = 1)
{
  std::mt19937 random(seed);
  OrientedPoints points;
  for (std::size_t i = 0; i < count; ++i)
  {
    const double angle = uniform(random, 0, 2 * M_PI);
    const Eigen::Vector3d n(std::cos(angle), std::sin(angle), 0);
    add(points, radius * n + Eigen::Vector3d(0, 0, uniform(random, -length / 2, length / 2)), n);
  }
  return points;
}

/// Square in z = 0, normal +z.
inline OrientedPoints plane(double side, std::size_t count, std::uint32_t seed = 1)
{
  std::mt19937 random(seed);
  OrientedPoints points;
  for (std::size_t i = 0; i < count; ++i)
    add(points, {uniform(random, -side / 2, side / 2), uniform(random, -side / 2, side / 2), 0},
        Eigen::Vector3d::UnitZ());
  return points;
}

/// Torus about z; the tube's angle is drawn so that the points are even on the surface.
inline OrientedPoints torus(double ring, double tube, std::size_t count, std::uint32_t seed = 1)
{
  std::mt19937 random(seed);
  OrientedPoints points;
  while (points.size() < count)
  {
    const double u = uniform(random, 0, 2 * M_PI);
    const double v = uniform(random, 0, 2 * M_PI);
    if (uniform(random, 0, ring + tube) > ring + tube * std::cos(v))
      continue;
    const Eigen::Vector3d n(std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v));
    add(points, Eigen::Vector3d(ring * std::cos(u), ring * std::sin(u), 0) + tube * n, n);
  }
  return points;
}

/// An asymmetric body: six faces of an L-shaped block, so that only one pose fits. About 80 x 50 x 30 mm.
inline OrientedPoints lBlock(double spacing, std::uint32_t seed = 1)
{
  std::mt19937 random(seed);
  OrientedPoints points;
  const auto face = [&](const Eigen::Vector3d& corner, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    const auto count = static_cast<std::size_t>(a.norm() * b.norm() / (spacing * spacing));
    for (std::size_t i = 0; i < count; ++i)
      add(points, corner + uniform(random, 0, 1) * a + uniform(random, 0, 1) * b, a.cross(b).normalized());
  };
  using V = Eigen::Vector3d;
  const double L = 0.08, W = 0.03, H = 0.05, T = 0.02;  // an L of thickness T, extruded by W along y
  face({0, 0, 0}, {0, W, 0}, {L, 0, 0});                // bottom
  face({0, 0, 0}, {0, 0, H}, {0, W, 0});                // back
  face({L, 0, 0}, {0, W, 0}, {0, 0, T});                // toe
  face({T, 0, T}, {L - T, 0, 0}, {0, W, 0});            // top of the foot
  face({T, 0, T}, {0, W, 0}, {0, 0, H - T});            // front of the leg
  face({0, 0, H}, {T, 0, 0}, {0, W, 0});                // top of the leg
  for (const double y : {0.0, W})
  {
    const V sign = y > 0 ? V(0, 1, 0) : V(0, -1, 0);
    const auto before = points.size();
    face({0, y, 0}, {L, 0, 0}, {0, 0, T});
    face({0, y, T}, {T, 0, 0}, {0, 0, H - T});
    for (std::size_t i = before; i < points.size(); ++i)
      points.normals[i] = sign.cast<float>();
  }
  return points;
}

inline double rotationError(const Pose& a, const Pose& b)
{
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}
}  // namespace test
}  // namespace bin_picking
