// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_physics.hpp"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bin_picking_perception/common/error.hpp"
#include "bullet_body.hpp"
#include "random.hpp"

namespace bin_picking::simulation
{
namespace
{
constexpr double GRAVITY = 9.81;          // m/s^2
constexpr double TOP_SPEED = 0.5;         // m/s: at most half a wall per step, so that nothing falls through another
// A pile rests when no point has moved farther than the first in the second. Less is never reached: parts with many
// contacts tremble and creep by some tenths of a millimetre.
constexpr double RESTING_MOVE = 0.001;    // metres
constexpr double RESTING_TIME = 0.2;      // seconds
constexpr double CALMING_TIME = 0.6;      // seconds of settling after which the damping begins to grow
constexpr double RAIL_HEIGHT = 2;         // metres: while parts fall, the walls are so high
constexpr double WALL_THICKNESS = 0.05;   // metres, outwards
constexpr double ROLLING_FRICTION = 0.002;  // of the part's radius: real parts are not perfectly round
constexpr int MAX_DROPS = 4;              // of one part that ends outside
constexpr int MAX_ATTITUDES = 200;

struct Item
{
  int id;
  int shape;
  int drops = 1;
  std::unique_ptr<btRigidBody> body;
};

/// A box from low to high, metres.
struct StaticBox
{
  StaticBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high)
    : shape(toBullet(0.5 * (high - low))), body(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &shape))
  {
    Pose T = Pose::Identity();
    T.translation() = 0.5 * (low + high);
    body.setWorldTransform(toBullet(T));
  }

  btBoxShape shape;
  btRigidBody body;
};
}  // namespace

struct BinPhysics::Impl
{
  Impl(std::vector<std::shared_ptr<const RigidBodyShape>> shapes, const Eigen::Vector3d& size,
       const PhysicsParameters& physics);
  ~Impl();

  void addWalls(double height, std::vector<std::unique_ptr<StaticBox>>& walls);
  void addStatic(StaticBox& box);
  void raiseRails() { addWalls(inner_size.z() + RAIL_HEIGHT, rails); }
  void lowerRails();

  Pose randomDrop(int shape, Random& random) const;
  double topBelow(const Eigen::AlignedBox2d& footprint) const;
  Pose placeAbove(const BulletShape& shape, const Eigen::Matrix3d& attitude, const Eigen::AlignedBox3d& extent,
                  Random& random) const;
  void release(Item& item, const Pose& T_bin_body);
  void add(int shape, Random& random);
  void again(Item& item, Random& random);
  void step();
  void advance(double seconds);
  void settle();
  std::vector<Pose> poses() const;
  double movedSince(const std::vector<Pose>& before) const;
  void setDamping(double linear, double angular);
  void removeItem(std::vector<Item>::iterator item);
  std::vector<Item>::iterator find(int id);
  bool outside(const Item& item) const;
  void bringBack(Random& random);
  bool reachesAboveRim() const;
  void requireBelowRim() const;

  std::vector<BulletShape> shapes;
  Eigen::Vector3d inner_size;
  PhysicsParameters parameters;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  std::vector<std::unique_ptr<StaticBox>> walls;
  std::vector<std::unique_ptr<StaticBox>> rails;
  std::vector<Item> items;
  int next_id = 1;
};

BinPhysics::Impl::Impl(std::vector<std::shared_ptr<const RigidBodyShape>> part_shapes, const Eigen::Vector3d& size,
                       const PhysicsParameters& physics)
  : inner_size(size), parameters(physics)
{
  checkRanges(parameters);
  for (const auto& shape : part_shapes)
    shapes.emplace_back(*shape);
  world.setGravity(btVector3(0, 0, static_cast<btScalar>(-GRAVITY * UNITS_PER_METRE)));
  world.getSolverInfo().m_numIterations = 20;
  addWalls(inner_size.z(), walls);
  const double half = 0.5 * inner_size.head<2>().maxCoeff() + WALL_THICKNESS;
  walls.push_back(std::make_unique<StaticBox>(Eigen::Vector3d(-half, -half, -WALL_THICKNESS), Eigen::Vector3d(half, half, 0)));
  addStatic(*walls.back());
  Random random(0);
  for (std::size_t k = 0; k < shapes.size(); ++k)
    randomDrop(static_cast<int>(k), random);  // throws if there is no room even in the empty bin
}

BinPhysics::Impl::~Impl()
{
  while (world.getNumCollisionObjects() > 0)
    world.removeCollisionObject(world.getCollisionObjectArray()[world.getNumCollisionObjects() - 1]);
}

void BinPhysics::Impl::addStatic(StaticBox& box)
{
  box.body.setFriction(static_cast<btScalar>(parameters.friction));
  box.body.setRestitution(static_cast<btScalar>(parameters.restitution));
  box.body.setRollingFriction(1);  // Bullet multiplies the coefficients of both bodies
  world.addRigidBody(&box.body);
}

void BinPhysics::Impl::addWalls(double height, std::vector<std::unique_ptr<StaticBox>>& boxes)
{
  const double x = 0.5 * inner_size.x();
  const double y = 0.5 * inner_size.y();
  const double t = WALL_THICKNESS;
  const Eigen::Vector3d corners[4][2] = {{{-x - t, -y - t, 0}, {-x, y + t, height}},
                                         {{x, -y - t, 0}, {x + t, y + t, height}},
                                         {{-x, -y - t, 0}, {x, -y, height}},
                                         {{-x, y, 0}, {x, y + t, height}}};
  for (const auto& [low, high] : corners)
  {
    boxes.push_back(std::make_unique<StaticBox>(low, high));
    addStatic(*boxes.back());
  }
}

void BinPhysics::Impl::lowerRails()
{
  for (const auto& rail : rails)
    world.removeRigidBody(&rail->body);
  rails.clear();
}

Pose BinPhysics::Impl::randomDrop(int shape_index, Random& random) const
{
  const BulletShape& shape = shapes[static_cast<std::size_t>(shape_index)];
  for (int k = 0; k < MAX_ATTITUDES; ++k)
  {
    const Eigen::Matrix3d attitude = random.rotation().toRotationMatrix();
    Eigen::AlignedBox3d extent;
    for (const Eigen::Vector3d& corner : shape.corners)
      extent.extend(attitude * corner);
    if ((extent.sizes().head<2>().array() < inner_size.head<2>().array()).all())
      return placeAbove(shape, attitude, extent, random);
  }
  throw ParameterError("the part is too large for the bin: its farthest point is " +
                       std::to_string(std::lround(1000 * shape.radius)) + " mm from its centre of mass, and the bin is " +
                       std::to_string(std::lround(1000 * inner_size.x())) + " mm x " +
                       std::to_string(std::lround(1000 * inner_size.y())) +
                       " mm inside; take a larger bin, or check the unit of the mesh");
}

Pose BinPhysics::Impl::placeAbove(const BulletShape&, const Eigen::Matrix3d& attitude, const Eigen::AlignedBox3d& extent,
                                  Random& random) const
{
  Pose T_bin_body = Pose::Identity();
  T_bin_body.linear() = attitude;
  for (int axis = 0; axis < 2; ++axis)
    T_bin_body.translation()[axis] =
        random.uniform(-0.5 * inner_size[axis] - extent.min()[axis], 0.5 * inner_size[axis] - extent.max()[axis]);
  const Eigen::Vector2d place = T_bin_body.translation().head<2>();
  const double top = topBelow({extent.min().head<2>() + place, extent.max().head<2>() + place});
  T_bin_body.translation().z() = top + parameters.drop_height - extent.min().z();
  return T_bin_body;
}

double BinPhysics::Impl::topBelow(const Eigen::AlignedBox2d& footprint) const
{
  double top = 0;
  for (const Item& item : items)
  {
    btVector3 low;
    btVector3 high;
    item.body->getAabb(low, high);
    const Eigen::AlignedBox2d other(Eigen::Vector2d(low.x(), low.y()) / UNITS_PER_METRE,
                                    Eigen::Vector2d(high.x(), high.y()) / UNITS_PER_METRE);
    if (other.intersects(footprint))
      top = std::max(top, static_cast<double>(high.z()) / UNITS_PER_METRE);
  }
  return top;
}

void BinPhysics::Impl::release(Item& item, const Pose& T_bin_body)
{
  item.body->setWorldTransform(toBullet(T_bin_body));
  item.body->setInterpolationWorldTransform(toBullet(T_bin_body));
  item.body->setLinearVelocity(btVector3(0, 0, 0));
  item.body->setAngularVelocity(btVector3(0, 0, 0));
  item.body->clearForces();
}

void BinPhysics::Impl::add(int shape_index, Random& random)
{
  const Pose T_bin_body = randomDrop(shape_index, random);
  BulletShape& shape = shapes[static_cast<std::size_t>(shape_index)];
  btRigidBody::btRigidBodyConstructionInfo info(shape.mass, nullptr, shape.compound.get(), shape.inertia);
  info.m_friction = static_cast<btScalar>(parameters.friction);
  info.m_restitution = static_cast<btScalar>(parameters.restitution);
  info.m_rollingFriction = info.m_spinningFriction =
      static_cast<btScalar>(ROLLING_FRICTION * shape.radius * UNITS_PER_METRE);
  Item item{next_id++, shape_index, 1, std::make_unique<btRigidBody>(info)};
  item.body->setActivationState(DISABLE_DEACTIVATION);
  release(item, T_bin_body);
  world.addRigidBody(item.body.get());
  items.push_back(std::move(item));
}

/// Lifts the part to a new place. Out of the world and back in, so that no contact of the old place is remembered.
void BinPhysics::Impl::again(Item& item, Random& random)
{
  world.removeRigidBody(item.body.get());
  release(item, randomDrop(item.shape, random));
  world.addRigidBody(item.body.get());
}

void BinPhysics::Impl::step()
{
  world.stepSimulation(static_cast<btScalar>(parameters.time_step), 0);
  const auto top_speed = static_cast<btScalar>(TOP_SPEED * UNITS_PER_METRE);
  for (Item& item : items)
  {
    const btScalar radius =
        static_cast<btScalar>(shapes[static_cast<std::size_t>(item.shape)].radius * UNITS_PER_METRE);
    const btScalar speed = item.body->getLinearVelocity().length();
    const btScalar spin = item.body->getAngularVelocity().length() * radius;
    if (speed > top_speed)
      item.body->setLinearVelocity(item.body->getLinearVelocity() * (top_speed / speed));
    if (spin > top_speed)
      item.body->setAngularVelocity(item.body->getAngularVelocity() * (top_speed / spin));
  }
}

void BinPhysics::Impl::advance(double seconds)
{
  for (double t = 0; t < seconds; t += parameters.time_step)
    step();
}

std::vector<Pose> BinPhysics::Impl::poses() const
{
  std::vector<Pose> poses;
  for (const Item& item : items)
    poses.push_back(fromBullet(item.body->getWorldTransform()));
  return poses;
}

/// The farthest that any point of a part has moved since. Speeds do not tell: bodies in contact tremble on the spot.
double BinPhysics::Impl::movedSince(const std::vector<Pose>& before) const
{
  double farthest = 0;
  const std::vector<Pose> now = poses();
  for (std::size_t k = 0; k < items.size(); ++k)
  {
    const double angle = Eigen::AngleAxisd(now[k].linear() * before[k].linear().transpose()).angle();
    farthest = std::max(farthest, (now[k].translation() - before[k].translation()).norm() +
                                      angle * shapes[static_cast<std::size_t>(items[k].shape)].radius);
  }
  return farthest;
}

void BinPhysics::Impl::setDamping(double linear, double angular)
{
  for (Item& item : items)
    item.body->setDamping(static_cast<btScalar>(linear), static_cast<btScalar>(angular));
}

/// Until all rest. Parts that roll to and fro are calmed by and by.
void BinPhysics::Impl::settle()
{
  for (double t = 0; t < parameters.max_settling_time; t += RESTING_TIME)
  {
    const double calming = std::clamp((t - CALMING_TIME) / (parameters.max_settling_time - CALMING_TIME), 0.0, 1.0);
    setDamping(0.02 + 0.97 * calming, 0.1 + 0.89 * calming);
    const std::vector<Pose> before = poses();
    advance(RESTING_TIME);
    if (movedSince(before) < RESTING_MOVE)
      break;
  }
  setDamping(0.02, 0.1);
  for (Item& item : items)
  {
    item.body->setLinearVelocity(btVector3(0, 0, 0));
    item.body->setAngularVelocity(btVector3(0, 0, 0));
  }
}

std::vector<Item>::iterator BinPhysics::Impl::find(int id)
{
  return std::find_if(items.begin(), items.end(), [id](const Item& item) { return item.id == id; });
}

void BinPhysics::Impl::removeItem(std::vector<Item>::iterator item)
{
  world.removeRigidBody(item->body.get());
  items.erase(item);
}

bool BinPhysics::Impl::outside(const Item& item) const
{
  const Eigen::Vector3d center = fromBullet(item.body->getWorldTransform()).translation();
  return std::abs(center.x()) > 0.5 * inner_size.x() || std::abs(center.y()) > 0.5 * inner_size.y() || center.z() < 0;
}

/// Drops again what has ended outside.
void BinPhysics::Impl::bringBack(Random& random)
{
  for (;;)
  {
    settle();
    const auto lost = std::find_if(items.begin(), items.end(), [this](const Item& item) { return outside(item); });
    if (lost == items.end())
      return;
    if (++lost->drops > MAX_DROPS)
      throw ParameterError("the bin is too full: of " + std::to_string(items.size()) +
                           " parts one keeps falling out; drop fewer parts or take a larger bin");
    again(*lost, random);
  }
}

bool BinPhysics::Impl::reachesAboveRim() const
{
  return std::any_of(items.begin(), items.end(), [this](const Item& item) {
    btVector3 low;
    btVector3 high;
    item.body->getAabb(low, high);
    return static_cast<double>(high.z()) / UNITS_PER_METRE > inner_size.z();
  });
}

void BinPhysics::Impl::requireBelowRim() const
{
  const auto above = std::count_if(items.begin(), items.end(), [this](const Item& item) {
    return fromBullet(item.body->getWorldTransform()).translation().z() > inner_size.z();
  });
  if (above > 0)
    throw ParameterError("the bin is too full: " + std::to_string(above) + " of " + std::to_string(items.size()) +
                         " parts lie above its rim; drop fewer parts or take a larger bin");
}

BinPhysics::BinPhysics(std::vector<std::shared_ptr<const RigidBodyShape>> shapes, const Eigen::Vector3d& inner_size,
                       const PhysicsParameters& parameters)
  : impl_(std::make_unique<Impl>(std::move(shapes), inner_size, parameters))
{
}
BinPhysics::~BinPhysics() = default;
BinPhysics::BinPhysics(BinPhysics&&) noexcept = default;
BinPhysics& BinPhysics::operator=(BinPhysics&&) noexcept = default;

void BinPhysics::drop(const std::vector<int>& shape_indices, std::uint32_t seed, const Progress& progress)
{
  Random random(seed);
  impl_->raiseRails();
  for (std::size_t k = 0; k < shape_indices.size(); ++k)
  {
    impl_->add(shape_indices[k], random);
    impl_->advance(impl_->parameters.drop_interval);
    if (progress)
      progress(static_cast<double>(k + 1) / static_cast<double>(shape_indices.size() + 2));
  }
  impl_->bringBack(random);
  impl_->lowerRails();
  if (impl_->reachesAboveRim())
    impl_->bringBack(random);
  impl_->requireBelowRim();
  if (progress)
    progress(1);
}

bool BinPhysics::remove(int id)
{
  const auto item = impl_->find(id);
  if (item == impl_->items.end())
    return false;
  impl_->removeItem(item);
  impl_->settle();
  return true;
}

bool BinPhysics::dropAgain(int id, std::uint32_t seed)
{
  const auto item = impl_->find(id);
  if (item == impl_->items.end())
    return false;
  Random random(seed);
  item->drops = 1;
  impl_->again(*item, random);
  impl_->bringBack(random);
  return true;
}

void BinPhysics::clear()
{
  while (!impl_->items.empty())
    impl_->removeItem(impl_->items.end() - 1);
}

std::vector<Body> BinPhysics::bodies() const
{
  std::vector<Body> bodies;
  for (const Item& item : impl_->items)
    bodies.push_back({item.id, item.shape,
                      fromBullet(item.body->getWorldTransform()) *
                          impl_->shapes[static_cast<std::size_t>(item.shape)].T_object_body.inverse()});
  return bodies;
}

void PhysicsParameters::visit(ParameterVisitor& v)
{
  v.field({"friction", "", "of part on part and part on bin; more makes steeper piles", 0, 1.5}, friction);
  v.field({"restitution", "", "bounciness; more takes longer to come to rest", 0, 0.9}, restitution);
  v.field({"drop_height", "m", "free space below a part when it is let go", 0, 0.5}, drop_height);
  v.field({"drop_interval", "s", "between one part and the next", 0.02, 2}, drop_interval);
  v.field({"time_step", "s", "of the integration; shorter is slower and lets parts overlap less", 0.0005, 0.01}, time_step);
  v.field({"max_settling_time", "s", "simulated time after which the last movement is stopped", 1, 60}, max_settling_time);
}
}  // namespace bin_picking::simulation
