// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "grip_scene.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace bin_picking::simulation
{
namespace
{
constexpr double DEPTH_STEP = 1e-4;  // metres

std::optional<double> firstTouch(const PlacedMesh& placed, const ConvexBody& body_bin, const Eigen::Vector3d& motion,
                                 double end)
{
  if (!placed.bounds_bin.intersects(boundsOf(body_bin, motion * end)))
    return std::nullopt;
  const ConvexBody body = transformed(body_bin, placed.T_mesh_bin);
  if (placed.mesh->contains(body.vertices.front()))
    return 0;
  return firstOverlap(*placed.mesh, body, placed.T_mesh_bin.linear() * motion, end);
}
}  // namespace

PlacedMesh::PlacedMesh(const CollisionMesh& mesh_in, const Pose& T_bin_mesh_in, std::string name_in, int id_in)
    : mesh(&mesh_in),
      T_bin_mesh(T_bin_mesh_in),
      T_mesh_bin(T_bin_mesh_in.inverse()),
      name(std::move(name_in)),
      id(id_in),
      bounds_bin(boundsOf(mesh_in.bounds(), T_bin_mesh_in))
{}

ConvexBody bodyInBin(const Gripper& gripper, std::size_t body, const Pose& T_bin_tool0, double opening)
{
  return transformed(gripper.bodyAt(body, opening), T_bin_tool0);
}

std::optional<Touch> firstTouch(const GripScene& scene, const Gripper& gripper, const GripperWay& way,
                                const Exception& is_allowed)
{
  std::optional<Touch> first;
  for (std::size_t b = 0; b < gripper.bodies.size(); ++b)
  {
    const ConvexBody body = bodyInBin(gripper, b, way.T_bin_tool0, way.opening);
    for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    {
      if (is_allowed(b, m))
        continue;
      const auto time = firstTouch(scene.meshes[m], body, way.motion_bin, first ? first->time : 1);
      if (time && (!first || *time < first->time))
        first = Touch{*time, b, m};
    }
  }
  return first;
}

double depthOnWay(const PlacedMesh& placed, const ConvexBody& body_bin, const Eigen::Vector3d& motion_bin)
{
  const ConvexBody body = transformed(body_bin, placed.T_mesh_bin);
  const Eigen::Vector3d motion = placed.T_mesh_bin.linear() * motion_bin;
  double low = 0;
  double high = MAX_DEPTH;
  while (high - low > DEPTH_STEP)
  {
    const double middle = 0.5 * (low + high);
    (firstOverlap(*placed.mesh, body, motion, 1, middle) ? low : high) = middle;
  }
  return high;
}
}  // namespace bin_picking::simulation
