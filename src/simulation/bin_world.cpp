// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_world.hpp"

#include "bullet_body.hpp"

namespace bin_picking::simulation
{
namespace
{
constexpr double GRAVITY = 9.81;         // m/s^2
constexpr double RAIL_HEIGHT = 2;        // metres above the rim
constexpr double WALL_THICKNESS = 0.05;  // metres, outwards: thick, so that nothing is pressed through
constexpr int SOLVER_ITERATIONS = 20;
}  // namespace

StaticBox::StaticBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high)
    : shape(toBullet(0.5 * (high - low))), body(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &shape))
{
  Pose T = Pose::Identity();
  T.translation() = 0.5 * (low + high);
  body.setWorldTransform(toBullet(T));
}

BinWorld::BinWorld(const Eigen::Vector3d& inner_size, const PhysicsParameters& parameters)
    : inner_size_(inner_size), parameters_(parameters)
{
  world_.setGravity(btVector3(0, 0, static_cast<btScalar>(-GRAVITY * UNITS_PER_METRE)));
  world_.getSolverInfo().m_numIterations = SOLVER_ITERATIONS;
  boxes_ = makeWalls(inner_size.z());
  const double half = 0.5 * inner_size.head<2>().maxCoeff() + WALL_THICKNESS;
  boxes_.push_back(makeBox({-half, -half, -WALL_THICKNESS}, {half, half, 0}));
}

std::unique_ptr<StaticBox> BinWorld::makeBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high)
{
  auto box = std::make_unique<StaticBox>(low, high);
  box->body.setFriction(static_cast<btScalar>(parameters_.friction));
  box->body.setRestitution(static_cast<btScalar>(parameters_.restitution));
  box->body.setRollingFriction(1);  // Bullet multiplies the coefficients of both bodies
  add(box->body);
  return box;
}

std::vector<std::unique_ptr<StaticBox>> BinWorld::makeWalls(double height)
{
  const double x = 0.5 * inner_size_.x();
  const double y = 0.5 * inner_size_.y();
  const double t = WALL_THICKNESS;
  const Eigen::Vector3d corners[4][2] = {{{-x - t, -y - t, 0}, {-x, y + t, height}},
                                         {{x, -y - t, 0}, {x + t, y + t, height}},
                                         {{-x, -y - t, 0}, {x, -y, height}},
                                         {{-x, y, 0}, {x, y + t, height}}};
  std::vector<std::unique_ptr<StaticBox>> walls;
  for (const auto& [low, high] : corners)
    walls.push_back(makeBox(low, high));
  return walls;
}

BinWorld::Rails::Rails(BinWorld& world) : world_(world), boxes_(world.makeWalls(world.inner_size_.z() + RAIL_HEIGHT)) {}

BinWorld::Rails::~Rails()
{
  for (const auto& box : boxes_)
    world_.remove(box->body);
}
}  // namespace bin_picking::simulation
