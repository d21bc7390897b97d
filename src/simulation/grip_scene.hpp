// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bin_picking_perception/grasping/gripper.hpp"
#include "collision_mesh.hpp"
#include "grip_trial.hpp"

namespace bin_picking::simulation
{
/// A mesh where it lies.
struct PlacedMesh
{
  PlacedMesh(const CollisionMesh& mesh_in, const Pose& T_bin_mesh_in, std::string name_in, int id_in);

  const CollisionMesh* mesh;
  Pose T_bin_mesh;
  Pose T_mesh_bin;
  std::string name;  ///< "wall at +x", "part 3 (three_way_tube)"
  int id;            ///< of the part; -1: of the bin
  Eigen::AlignedBox3d bounds_bin;

  bool isPart() const { return id >= 0; }
};

/// All that lies or stands around, and which of it is the target: index into meshes, or nothing.
struct GripScene
{
  std::vector<PlacedMesh> meshes;
  std::optional<std::size_t> target;
  double rim = 0;  ///< height of the bin's walls, bin frame, metres

  bool isTarget(std::size_t index) const { return target && *target == index; }
};

/// A straight motion of the gripper at one opening.
struct GripperWay
{
  Pose T_bin_tool0 = Pose::Identity();                   ///< at the start
  Eigen::Vector3d motion_bin = Eigen::Vector3d::Zero();  ///< metres
  double opening = 0;
};

/// The first touch on a way.
struct Touch
{
  double time = 0;       ///< share of the way, [0, 1]
  std::size_t body = 0;  ///< of the gripper
  std::size_t mesh = 0;  ///< of the scene
};

/// Which pairs do not count.
using Exception = std::function<bool(std::size_t body, std::size_t mesh)>;

ConvexBody bodyInBin(const Gripper& gripper, std::size_t body, const Pose& T_bin_tool0, double opening);

/// Bodies that begin within a solid count as touching at once.
std::optional<Touch> firstTouch(const GripScene& scene, const Gripper& gripper, const GripperWay& way,
                                const Exception& is_allowed);

/// How deep a body and a mesh reach into each other on the way at most, to 0.1 mm; no more than MAX_DEPTH.
double depthOnWay(const PlacedMesh& mesh, const ConvexBody& body_bin, const Eigen::Vector3d& motion_bin);
constexpr double MAX_DEPTH = 0.02;  // metres
}  // namespace bin_picking::simulation
