// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "held_part.hpp"

#include <algorithm>
#include <cmath>

namespace bin_picking::simulation
{
namespace
{
constexpr double THINNEST = 1e-4;  // metres, of what is left of a side; the way is tested as a whole, so that it is met

/// The deepest place at which points of one lie inside the other.
double reach(const PlacedMesh& one, const PlacedMesh& other, const Eigen::Vector3d& motion_of_one)
{
  Pose T_other_one = other.T_mesh_bin * one.T_bin_mesh;
  T_other_one.translation() += other.T_mesh_bin.linear() * motion_of_one;
  const Pose T_one_other = T_other_one.inverse();
  double deepest = 0;
  one.mesh->surfaceTree().visit(boundsOf(other.mesh->bounds(), T_one_other), [&](std::size_t k) {
    deepest = std::max(deepest, other.mesh->depth(T_other_one * one.mesh->surface()[k]));
  });
  return deepest;
}

/// How deep two parts reach into each other, one of them moved.
double depthBetween(const PlacedMesh& held, const PlacedMesh& other, const Eigen::Vector3d& motion_of_held)
{
  const Eigen::AlignedBox3d held_bounds(held.bounds_bin.min() + motion_of_held, held.bounds_bin.max() + motion_of_held);
  if (!held_bounds.intersects(other.bounds_bin))
    return 0;
  return std::max(reach(held, other, motion_of_held), reach(other, held, -motion_of_held));
}

/// A side of the bin, drawn in on all sides. One that is too thin for that moves outwards: no play lets a part through.
ConvexBody drawnIn(const Eigen::AlignedBox3d& box, double by)
{
  const Eigen::Vector3d size = (box.sizes() - Eigen::Vector3d::Constant(2 * by)).cwiseMax(THINNEST);
  Eigen::Index across = 0;
  box.sizes().minCoeff(&across);
  Eigen::Vector3d center = box.center();
  const double half = 0.5 * box.sizes()[across] - by - 0.5 * size[across];  // below 0 where it is too thin
  center[across] -= center[across] > 0 ? half : -half;
  return makeBox(center, size);
}

double depthInBox(const Eigen::AlignedBox3d& box, const PlacedMesh& part)
{
  double deepest = 0;
  for (const Eigen::Vector3d& p : part.mesh->surface())
  {
    const Eigen::Vector3d p_bin = part.T_bin_mesh * p;
    deepest = std::max(deepest, std::min((p_bin - box.min()).minCoeff(), (box.max() - p_bin).minCoeff()));
  }
  return deepest;
}

/// When the held part runs into a box of the bin.
std::optional<double> touchOfBox(const PlacedMesh& held, const Eigen::AlignedBox3d& box, double play,
                                 const Eigen::Vector3d& shift_bin, const Eigen::Vector3d& motion_bin)
{
  // As the part sees it, the bin moves.
  Pose T_mesh_bin = held.T_mesh_bin;
  T_mesh_bin.translation() -= held.T_mesh_bin.linear() * shift_bin;
  return firstOverlap(*held.mesh, transformed(drawnIn(box, play), T_mesh_bin),
                      -(held.T_mesh_bin.linear() * motion_bin));
}

std::optional<HeldTouch> firstTouchOfBin(const GripScene& scene, const Eigen::Vector3d& shift_bin,
                                         const Eigen::Vector3d& motion_bin, const GripTrialParameters& parameters)
{
  const PlacedMesh& held = scene.meshes[*scene.target];
  std::optional<HeldTouch> first;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
  {
    const PlacedMesh& side = scene.meshes[m];
    if (side.isPart())
      continue;
    const double play = depthInBox(side.bounds_bin, held) + parameters.bin_play;
    const auto time = touchOfBox(held, side.bounds_bin, play, shift_bin, motion_bin);
    if (time && (!first || *time < first->time))
      first = HeldTouch{*time, m, parameters.bin_play};
  }
  return first;
}
}  // namespace

std::optional<HeldTouch> firstTouchOfHeld(const GripScene& scene, const Eigen::Vector3d& shift_bin,
                                          const Eigen::Vector3d& motion_bin, const GripTrialParameters& parameters)
{
  const std::optional<HeldTouch> bin = firstTouchOfBin(scene, shift_bin, motion_bin, parameters);
  const PlacedMesh& held = scene.meshes[*scene.target];
  Eigen::AlignedBox3d way = held.bounds_bin;
  way.extend(Eigen::AlignedBox3d(held.bounds_bin).translate(shift_bin + motion_bin));
  std::vector<std::pair<std::size_t, double>> others;  // with the depth at rest
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    if (scene.meshes[m].isPart() && !scene.isTarget(m) && way.intersects(scene.meshes[m].bounds_bin))
      others.emplace_back(m, depthBetween(held, scene.meshes[m], Eigen::Vector3d::Zero()));
  const int steps = std::max(1, static_cast<int>(std::ceil(motion_bin.norm() / parameters.retreat_step)));
  for (int k = 0; k <= steps; ++k)
  {
    const double time = static_cast<double>(k) / steps;
    if (bin && bin->time <= time)
      return bin;
    for (const auto& [m, at_rest] : others)
    {
      const double deeper = depthBetween(held, scene.meshes[m], shift_bin + time * motion_bin) - at_rest;
      if (deeper > parameters.max_drag)
        return HeldTouch{time, m, deeper};
    }
  }
  return bin;
}
}  // namespace bin_picking::simulation
