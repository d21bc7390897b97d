// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "bin_world.hpp"
#include "bullet_body.hpp"

namespace bin_picking::simulation
{
/// Parts in a bin that move until they rest. Frame and lengths as in BinPhysics.
class Pile
{
public:
  struct Item
  {
    int id = 0;
    int shape = 0;
    std::unique_ptr<btRigidBody> body;

    Pose T_bin_body() const { return fromBullet(body->getWorldTransform()); }
    /// Axis-parallel, metres.
    Eigen::AlignedBox3d box() const;
  };
  using Iterator = std::vector<Item>::iterator;

  /// \param shapes must outlive the pile
  Pile(const std::vector<BulletShape>& shapes, const Eigen::Vector3d& inner_size, const PhysicsParameters& parameters);

  std::vector<Item>& items() { return items_; }
  Iterator find(int id);

  void add(int id, int shape, const Pose& T_bin_body);
  /// Takes a part from its place to another, at which it stands still until time goes on.
  void move(Item& item, const Pose& T_bin_body);
  void remove(Iterator item);

  void advance(double seconds);
  /// Until all rest, and no longer than the parameters say; then all stand still.
  void settle();

  /// See BinWorld.
  BinWorld::Rails raiseRails() { return BinWorld::Rails(world_); }

private:
  const BulletShape& shapeOf(const Item& item) const { return shapes_[static_cast<std::size_t>(item.shape)]; }
  void step();
  void limitSpeed(const Item& item);
  std::vector<Pose> poses() const;
  double movedSince(const std::vector<Pose>& before) const;
  void setDamping(double linear, double angular);

  const std::vector<BulletShape>& shapes_;
  PhysicsParameters parameters_;
  std::vector<Item> items_;  ///< before the world, see BinWorld::add
  BinWorld world_;
};
}  // namespace bin_picking::simulation
