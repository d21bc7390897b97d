// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "pile.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bin_picking::simulation
{
namespace
{
constexpr double TOP_SPEED = 0.5;  // m/s: at most half a wall of a part per step, so that nothing falls through another
// A pile rests when in RESTING_TIME no point of it moves farther than RESTING_MOVE. Less is never reached: parts with
// many contacts tremble and creep by some tenths of a millimetre.
constexpr double RESTING_MOVE = 0.001;      // metres
constexpr double RESTING_TIME = 0.2;        // seconds
constexpr double CALMING_TIME = 0.6;        // seconds of settling after which the damping begins to grow
constexpr double ROLLING_FRICTION = 0.002;  // of the part's radius: real parts are not perfectly round
constexpr double LINEAR_DAMPING = 0.02;     // share of the speed that is lost in a second
constexpr double ANGULAR_DAMPING = 0.1;

void stop(btRigidBody& body)
{
  body.setLinearVelocity(btVector3(0, 0, 0));
  body.setAngularVelocity(btVector3(0, 0, 0));
}

void place(btRigidBody& body, const Pose& T_bin_body)
{
  body.setWorldTransform(toBullet(T_bin_body));
  body.setInterpolationWorldTransform(toBullet(T_bin_body));
  stop(body);
  body.clearForces();
}
}  // namespace

Eigen::AlignedBox3d Pile::Item::box() const
{
  btVector3 low;
  btVector3 high;
  body->getAabb(low, high);
  return {Eigen::Vector3d(low.x(), low.y(), low.z()) / UNITS_PER_METRE,
          Eigen::Vector3d(high.x(), high.y(), high.z()) / UNITS_PER_METRE};
}

Pile::Pile(const std::vector<BulletShape>& shapes, const Eigen::Vector3d& inner_size,
           const PhysicsParameters& parameters)
    : shapes_(shapes), parameters_(parameters), world_(inner_size, parameters)
{}

Pile::Iterator Pile::find(int id)
{
  return std::find_if(items_.begin(), items_.end(), [id](const Item& item) { return item.id == id; });
}

void Pile::add(int id, int shape_index, const Pose& T_bin_body)
{
  const BulletShape& shape = shapes_[static_cast<std::size_t>(shape_index)];
  btRigidBody::btRigidBodyConstructionInfo info(shape.mass, nullptr, shape.compound.get(), shape.inertia);
  info.m_friction = static_cast<btScalar>(parameters_.friction);
  info.m_restitution = static_cast<btScalar>(parameters_.restitution);
  info.m_rollingFriction = info.m_spinningFriction =
      static_cast<btScalar>(ROLLING_FRICTION * shape.radius * UNITS_PER_METRE);
  items_.push_back({id, shape_index, std::make_unique<btRigidBody>(info)});
  btRigidBody& body = *items_.back().body;
  body.setActivationState(DISABLE_DEACTIVATION);
  place(body, T_bin_body);
  world_.add(body);
}

void Pile::move(Item& item, const Pose& T_bin_body)
{
  world_.remove(*item.body);  // and back in, so that no contact of the old place is remembered
  place(*item.body, T_bin_body);
  world_.add(*item.body);
}

void Pile::remove(Iterator item)
{
  world_.remove(*item->body);
  items_.erase(item);
}

void Pile::step()
{
  world_.step();
  for (const Item& item : items_)
    limitSpeed(item);
}

void Pile::limitSpeed(const Item& item)
{
  const auto top_speed = static_cast<btScalar>(TOP_SPEED * UNITS_PER_METRE);
  const auto radius = static_cast<btScalar>(shapeOf(item).radius * UNITS_PER_METRE);
  const btScalar speed = item.body->getLinearVelocity().length();
  const btScalar spin = item.body->getAngularVelocity().length() * radius;
  if (speed > top_speed)
    item.body->setLinearVelocity(item.body->getLinearVelocity() * (top_speed / speed));
  if (spin > top_speed)
    item.body->setAngularVelocity(item.body->getAngularVelocity() * (top_speed / spin));
}

void Pile::advance(double seconds)
{
  const auto steps = std::lround(seconds / parameters_.time_step);
  for (long k = 0; k < steps; ++k)
    step();
}

std::vector<Pose> Pile::poses() const
{
  std::vector<Pose> poses;
  for (const Item& item : items_)
    poses.push_back(item.T_bin_body());
  return poses;
}

/// The farthest that any point of a part has moved since. Speeds do not tell: bodies in contact tremble on the spot.
double Pile::movedSince(const std::vector<Pose>& before) const
{
  double farthest = 0;
  const std::vector<Pose> now = poses();
  for (std::size_t k = 0; k < items_.size(); ++k)
  {
    if (now[k].translation().z() < 0)
      continue;  // fallen out of the bin, it falls for ever
    const double angle = Eigen::AngleAxisd(now[k].linear() * before[k].linear().transpose()).angle();
    farthest =
        std::max(farthest, (now[k].translation() - before[k].translation()).norm() + angle * shapeOf(items_[k]).radius);
  }
  return farthest;
}

void Pile::setDamping(double linear, double angular)
{
  for (Item& item : items_)
    item.body->setDamping(static_cast<btScalar>(linear), static_cast<btScalar>(angular));
}

void Pile::settle()
{
  for (double t = 0; t < parameters_.max_settling_time; t += RESTING_TIME)
  {
    // Parts that roll to and fro are calmed by and by.
    const double calming = std::clamp((t - CALMING_TIME) / (parameters_.max_settling_time - CALMING_TIME), 0.0, 1.0);
    setDamping(LINEAR_DAMPING + 0.97 * calming, ANGULAR_DAMPING + 0.89 * calming);
    const std::vector<Pose> before = poses();
    advance(RESTING_TIME);
    if (movedSince(before) < RESTING_MOVE)
      break;
  }
  setDamping(LINEAR_DAMPING, ANGULAR_DAMPING);
  for (const Item& item : items_)
    stop(*item.body);
}
}  // namespace bin_picking::simulation
