// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "physics_parameters.hpp"
#include "rigid_body.hpp"

namespace bin_picking::simulation
{
/// One part in the bin.
struct Body
{
  int id = 0;     ///< never used twice in one BinPhysics
  int shape = 0;  ///< index into the shapes given to the constructor
  Pose T_bin_object = Pose::Identity();
};

/// Rigid bodies in a bin under gravity (Bullet). Frame: origin in the middle of the inner floor, z up, x along the
/// length. The same calls in the same order give the same bits. Not thread-safe.
class BinPhysics
{
public:
  /// Called now and then with the share that is done, [0, 1].
  using Progress = std::function<void(double)>;

  /// \param inner_size length, width, height of the bin, metres
  /// \throws ParameterError a parameter is out of its range; a shape does not fit into the bin
  BinPhysics(const std::vector<std::shared_ptr<const RigidBodyShape>>& shapes, const Eigen::Vector3d& inner_size,
             const PhysicsParameters& parameters);
  ~BinPhysics();
  BinPhysics(BinPhysics&&) noexcept;
  BinPhysics& operator=(BinPhysics&&) noexcept;

  /// Drops parts one after the other, at random places and attitudes, just above what lies there already, and waits
  /// until all rest. A part that ends outside is dropped again, a few times.
  /// \param shape_indices what to drop, in this order
  /// \throws ParameterError the bin is too full: parts end outside again and again, or lie above the rim. What
  ///   was dropped stays where it is until it is removed or cleared.
  void drop(const std::vector<int>& shape_indices, std::uint32_t seed, const Progress& progress = {});

  /// Takes a part away and waits until the others rest in the bin. False: there is no such part.
  /// \throws ParameterError another part falls out again and again
  bool remove(int id);
  /// Lifts a part out and lets it fall back in at a random place and attitude; waits until all rest in the bin. False,
  /// and throws: as above.
  bool dropAgain(int id, std::uint32_t seed);
  /// Takes all parts away; what is dropped from then on falls as in a new bin.
  void clear();

  /// In the order of dropping.
  std::vector<Body> bodies() const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace bin_picking::simulation
