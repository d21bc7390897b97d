// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_physics.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bin_picking_perception/common/error.hpp"
#include "drop_placement.hpp"
#include "pile.hpp"

namespace bin_picking::simulation
{
namespace
{
constexpr int MAX_RETURNS = 4;  // of what ends outside

std::vector<BulletShape> bulletShapes(const std::vector<std::shared_ptr<const RigidBodyShape>>& shapes)
{
  std::vector<BulletShape> result;
  result.reserve(shapes.size());
  for (const auto& shape : shapes)
    result.emplace_back(*shape);
  return result;
}
}  // namespace

struct BinPhysics::Impl
{
  Impl(const std::vector<std::shared_ptr<const RigidBodyShape>>& part_shapes, const Eigen::Vector3d& size,
       const PhysicsParameters& physics);

  Pose randomPlace(int shape, Random& random);
  bool outside(const Pile::Item& item) const;
  void bringBack(Random& random);
  bool reachesAboveRim();
  void requireBelowRim();

  std::vector<BulletShape> shapes;
  Eigen::Vector3d inner_size;
  PhysicsParameters parameters;
  std::unique_ptr<Pile> pile;
  int next_id = 1;
};

BinPhysics::Impl::Impl(const std::vector<std::shared_ptr<const RigidBodyShape>>& part_shapes,
                       const Eigen::Vector3d& size, const PhysicsParameters& physics)
    : shapes(bulletShapes(part_shapes)), inner_size(size), parameters(physics)
{
  checkRanges(parameters);
  Random random(0);
  for (const BulletShape& shape : shapes)
    randomDrop(shape, {inner_size, 0}, random);  // throws if there is no room even in the empty bin
  pile = std::make_unique<Pile>(shapes, inner_size, parameters);
}

Pose BinPhysics::Impl::randomPlace(int shape, Random& random)
{
  DropSpace space = {inner_size, parameters.drop_height};
  for (const Pile::Item& item : pile->items())
    space.occupied.push_back(item.box());
  return randomDrop(shapes[static_cast<std::size_t>(shape)], space, random);
}

bool BinPhysics::Impl::outside(const Pile::Item& item) const
{
  const Eigen::Vector3d center = item.T_bin_body().translation();
  const Eigen::Vector2d half = 0.5 * inner_size.head<2>();
  const bool inside = std::abs(center.x()) <= half.x() && std::abs(center.y()) <= half.y() && center.z() >= 0;
  return !inside;  // so is what is not finite
}

/// Waits until all rest, and drops again what has ended outside.
void BinPhysics::Impl::bringBack(Random& random)
{
  for (int k = 0;; ++k)
  {
    pile->settle();
    const auto lost = std::count_if(pile->items().begin(), pile->items().end(),
                                    [this](const Pile::Item& item) { return outside(item); });
    if (lost == 0)
      return;
    if (k == MAX_RETURNS)
      throw ParameterError("the bin is too full: " + std::to_string(lost) + " of " +
                           std::to_string(pile->items().size()) +
                           " parts keep falling out; drop fewer parts or take a larger bin");
    for (Pile::Item& item : pile->items())
      if (outside(item))
        pile->move(item, randomPlace(item.shape, random));
  }
}

bool BinPhysics::Impl::reachesAboveRim()
{
  return std::any_of(pile->items().begin(), pile->items().end(),
                     [this](const Pile::Item& item) { return item.box().max().z() > inner_size.z(); });
}

void BinPhysics::Impl::requireBelowRim()
{
  const auto above = std::count_if(pile->items().begin(), pile->items().end(), [this](const Pile::Item& item) {
    return item.T_bin_body().translation().z() > inner_size.z();
  });
  if (above > 0)
    throw ParameterError("the bin is too full: " + std::to_string(above) + " of " +
                         std::to_string(pile->items().size()) +
                         " parts lie above its rim; drop fewer parts or take a larger bin");
}

BinPhysics::BinPhysics(const std::vector<std::shared_ptr<const RigidBodyShape>>& shapes,
                       const Eigen::Vector3d& inner_size, const PhysicsParameters& parameters)
    : impl_(std::make_unique<Impl>(shapes, inner_size, parameters))
{}
BinPhysics::~BinPhysics() = default;
BinPhysics::BinPhysics(BinPhysics&&) noexcept = default;
BinPhysics& BinPhysics::operator=(BinPhysics&&) noexcept = default;

void BinPhysics::drop(const std::vector<int>& shape_indices, std::uint32_t seed, const Progress& progress)
{
  Random random(seed);
  {
    const BinWorld::Rails rails = impl_->pile->raiseRails();
    for (std::size_t k = 0; k < shape_indices.size(); ++k)
    {
      impl_->pile->add(impl_->next_id++, shape_indices[k], impl_->randomPlace(shape_indices[k], random));
      impl_->pile->advance(impl_->parameters.drop_interval);
      if (progress)
        progress(static_cast<double>(k + 1) / static_cast<double>(shape_indices.size() + 2));
    }
    impl_->bringBack(random);
  }
  if (impl_->reachesAboveRim())
    impl_->bringBack(random);
  impl_->requireBelowRim();
  if (progress)
    progress(1);
}

bool BinPhysics::remove(int id)
{
  const auto item = impl_->pile->find(id);
  if (item == impl_->pile->items().end())
    return false;
  impl_->pile->remove(item);
  Random random(static_cast<std::uint32_t>(id));
  impl_->bringBack(random);
  return true;
}

bool BinPhysics::dropAgain(int id, std::uint32_t seed)
{
  const auto item = impl_->pile->find(id);
  if (item == impl_->pile->items().end())
    return false;
  Random random(seed);
  impl_->pile->move(*item, impl_->randomPlace(item->shape, random));
  impl_->bringBack(random);
  return true;
}

void BinPhysics::clear()
{
  // A new world: an emptied one keeps orders and numbers from which the next pile would come out differently.
  impl_->pile = std::make_unique<Pile>(impl_->shapes, impl_->inner_size, impl_->parameters);
}

std::vector<Body> BinPhysics::bodies() const
{
  std::vector<Body> bodies;
  for (const Pile::Item& item : impl_->pile->items())
    bodies.push_back({item.id, item.shape,
                      item.T_bin_body() * impl_->shapes[static_cast<std::size_t>(item.shape)].T_object_body.inverse()});
  return bodies;
}
}  // namespace bin_picking::simulation
