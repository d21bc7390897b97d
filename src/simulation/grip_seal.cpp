// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "bin_picking_perception/common/figures.hpp"
#include "bin_picking_perception/common/ray_triangle.hpp"
#include "grip_closing.hpp"

namespace bin_picking::simulation
{
namespace
{
constexpr int RING_POINTS = 16;
constexpr double RINGS[] = {0.0, 0.5, 0.9};  // shares of the lip's radius: a hole under the cup leaks as well

struct Hit
{
  double height = std::numeric_limits<double>::infinity();  // along the ray, metres
  double facing = 0;                                        // cosine between the surface's normal and against the ray
  std::size_t mesh = 0;
};

/// The first surface within `reach` before and behind p.
Hit lookAlong(const GripScene& scene, const Eigen::Vector3d& p_bin, const Eigen::Vector3d& direction_bin, double reach)
{
  Hit first;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
  {
    const PlacedMesh& placed = scene.meshes[m];
    const Eigen::Vector3d p = placed.T_mesh_bin * p_bin;
    const Eigen::Vector3d direction = placed.T_mesh_bin.linear() * direction_bin;
    Eigen::AlignedBox3d line(Eigen::Vector3d(p - reach * direction));
    line.extend(p + reach * direction);
    placed.mesh->tree().visit(line, [&](std::size_t k) {
      const Triangle& t = placed.mesh->triangles()[k];
      const auto height = crossing(t[0], t[1] - t[0], t[2] - t[0], p, direction);
      if (height && std::abs(*height) <= reach && *height < first.height)
        first = {*height, -(t[1] - t[0]).cross(t[2] - t[0]).normalized().dot(direction), m};
    });
  }
  return first;
}

/// Half of the smaller of the lip's extents across the approach, metres.
double lipRadius(const Gripper& gripper)
{
  Eigen::AlignedBox3d lip;
  const Pose T_tip_tool0 = gripper.T_tool0_tip(0).inverse();
  for (std::size_t b = 0; b < gripper.bodies.size(); ++b)
    if (gripper.bodies[b].touches_part)
      for (const Eigen::Vector3d& p : gripper.bodyAt(b, 0).vertices)
        lip.extend(T_tip_tool0 * p);
  return 0.5 * lip.sizes().head<2>().minCoeff();
}

std::string leak(const GripScene& scene, const Hit& hit, const GripTrialParameters& parameters)
{
  if (std::isinf(hit.height))
    return "The suction lip does not seal: at a place of its ring there is no surface within " +
           millimetres(parameters.seal_gap) + " (seal_gap).";
  if (!scene.isTarget(hit.mesh))
    return "The suction lip does not seal: it also lies on " + scene.meshes[hit.mesh].name + ".";
  char angle[64];
  std::snprintf(angle, sizeof(angle), "%.0f deg, %.0f deg", std::acos(std::clamp(hit.facing, -1.0, 1.0)) * 180 / M_PI,
                parameters.seal_angle * 180 / M_PI);
  return "The suction lip does not seal: the surface of " + scene.meshes[hit.mesh].name + " leans by " + angle +
         " are allowed (seal_angle).";
}
}  // namespace

Closing seal(GripScene& scene, const Gripper& gripper, const GripPath& path, const GripTrialParameters& parameters)
{
  Closing closing;
  const Pose T_bin_tip = path.T_bin_tool0_grasp * gripper.T_tool0_tip(0);
  const Eigen::Vector3d direction = T_bin_tip.linear().col(2);
  const double radius = lipRadius(gripper);
  for (const double ring : RINGS)
    for (int k = 0; k < (ring > 0 ? RING_POINTS : 1); ++k)
    {
      const double angle = 2 * M_PI * k / RING_POINTS;
      const Eigen::Vector3d p = T_bin_tip * (ring * radius * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0));
      const Hit hit = lookAlong(scene, p, direction, parameters.seal_gap);
      if (!scene.target && std::isfinite(hit.height) && scene.meshes[hit.mesh].isPart())
        scene.target = hit.mesh;
      if (!scene.isTarget(hit.mesh) || !(hit.facing >= std::cos(parameters.seal_angle)))
      {
        closing.missed = leak(scene, hit, parameters);
        return closing;
      }
    }
  return closing;
}
}  // namespace bin_picking::simulation
