// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <btBulletDynamicsCommon.h>

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "physics_parameters.hpp"

namespace bin_picking::simulation
{
/// A box that does not move.
struct StaticBox
{
  /// From one corner to the opposite one, metres.
  StaticBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high);

  btBoxShape shape;
  btRigidBody body;
};

/// Bullet's world with a bin in it: floor and walls. Frame and lengths as in BinPhysics.
class BinWorld
{
public:
  BinWorld(const Eigen::Vector3d& inner_size, const PhysicsParameters& parameters);

  /// The body stays the caller's; it must outlive the world or be removed.
  void add(btRigidBody& body) { world_.addRigidBody(&body); }
  void remove(btRigidBody& body) { world_.removeRigidBody(&body); }
  /// One time step.
  void step() { world_.stepSimulation(static_cast<btScalar>(parameters_.time_step), 0); }

  /// While one lives the walls are so high that no falling part gets over them.
  class Rails
  {
  public:
    explicit Rails(BinWorld& world);
    ~Rails();
    Rails(const Rails&) = delete;
    Rails& operator=(const Rails&) = delete;

  private:
    BinWorld& world_;
    std::vector<std::unique_ptr<StaticBox>> boxes_;
  };

private:
  std::unique_ptr<StaticBox> makeBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high);
  std::vector<std::unique_ptr<StaticBox>> makeWalls(double height);

  Eigen::Vector3d inner_size_;
  PhysicsParameters parameters_;
  std::vector<std::unique_ptr<StaticBox>> boxes_;  ///< before the world, which touches its bodies when it goes
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
};
}  // namespace bin_picking::simulation
