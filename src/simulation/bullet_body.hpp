// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>

#include <memory>
#include <string>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "rigid_body.hpp"

namespace bin_picking::simulation
{
/// Bullet is made for bodies of about one to ten units; a unit of ours is a centimetre.
constexpr double UNITS_PER_METRE = 100;

btVector3 toBullet(const Eigen::Vector3d& metres);
btTransform toBullet(const Pose& T);
Pose fromBullet(const btTransform& T);

/// A part as Bullet wants it: origin in the centre of mass, axes along the principal axes of inertia.
struct BulletShape
{
  explicit BulletShape(const RigidBodyShape& shape);

  std::string name;  ///< for messages
  Pose T_object_body = Pose::Identity();
  btScalar mass = 0;
  btVector3 inertia;                     ///< about the principal axes
  double radius = 0;                     ///< metres
  std::vector<Eigen::Vector3d> corners;  ///< of all pieces, body frame, metres
  std::vector<std::unique_ptr<btConvexHullShape>> pieces;
  std::unique_ptr<btCompoundShape> compound;
};
}  // namespace bin_picking::simulation
