// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// Mass properties against closed formulas.
#include "rigid_body.hpp"

#include <gtest/gtest.h>

#include "bin_picking_perception/common/error.hpp"
#include "core/mesh_shapes.hpp"
#include "core/temporary_folder.hpp"

using namespace bin_picking;
using namespace bin_picking::simulation;
using namespace bin_picking::test;

namespace
{
/// Vertices are floats: relative to the largest number of the formula.
constexpr double FLOAT_ROUNDING = 1e-6;

void expectInertia(const RigidBodyShape& shape, const Eigen::Matrix3d& expected)
{
  EXPECT_LT((shape.inertia - expected).cwiseAbs().maxCoeff(), FLOAT_ROUNDING * expected.maxCoeff())
      << shape.inertia << "\nexpected\n"
      << expected;
}

Eigen::Matrix3d boxInertia(double x, double y, double z)
{
  return x * y * z / 12 * Eigen::Vector3d(y * y + z * z, x * x + z * z, x * x + y * y).asDiagonal().toDenseMatrix();
}

/// Area of a regular polygon and its polar second moment about the middle.
std::pair<double, double> polygon(double radius, int sides)
{
  const double angle = 2 * M_PI / sides;
  const double area = sides * radius * radius * std::sin(angle) / 2;
  return {area, area * radius * radius * (2 + std::cos(angle)) / 6};
}
}  // namespace

TEST(RigidBody, boxHasTheMassPropertiesOfABox)
{
  const RigidBodyShape shape = makeRigidBodyShape(box(0.08f, 0.04f, 0.02f));
  EXPECT_NEAR(shape.volume, 0.08 * 0.04 * 0.02, FLOAT_ROUNDING * 64e-6);
  EXPECT_LT(shape.center_of_mass.norm(), 1e-9);
  EXPECT_NEAR(shape.radius, 0.5 * std::sqrt(0.0064 + 0.0016 + 0.0004), 1e-8);
  expectInertia(shape, boxInertia(0.08, 0.04, 0.02));
}

TEST(RigidBody, massPropertiesMoveWithTheMesh)
{
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 3).normalized()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(0.05, -0.02, 0.1);
  const RigidBodyShape shape = makeRigidBodyShape(moved(box(0.08f, 0.04f, 0.02f), T));
  EXPECT_LT((shape.center_of_mass - T.translation()).norm(), 1e-7);
  // About the centre of mass, not about the origin of the mesh; ten times the rounding, as the numbers are larger.
  const Eigen::Matrix3d expected = T.linear() * boxInertia(0.08, 0.04, 0.02) * T.linear().transpose();
  EXPECT_LT((shape.inertia - expected).cwiseAbs().maxCoeff(), 10 * FLOAT_ROUNDING * expected.maxCoeff());
}

TEST(RigidBody, fineSphereComesNearTheSphere)
{
  const double radius = 0.03;
  const RigidBodyShape shape = makeRigidBodyShape(sphereMesh(0.03f, 5));
  const double volume = 4.0 / 3 * M_PI * std::pow(radius, 3);
  // The facets lie below the sphere by at most (edge / radius)^2 / 8 with edges of a sixty-fourth of a turn at most.
  const double flat = std::pow(2 * M_PI / 64, 2) / 8;
  EXPECT_LT(shape.volume, volume);
  EXPECT_GT(shape.volume, volume * (1 - 3 * flat));
  EXPECT_LT(shape.center_of_mass.norm(), 1e-8);
  const double moment = 0.4 * volume * radius * radius;
  for (int axis = 0; axis < 3; ++axis)
  {
    EXPECT_LT(shape.inertia(axis, axis), moment);
    EXPECT_GT(shape.inertia(axis, axis), moment * (1 - 5 * flat));
  }
}

TEST(RigidBody, boreOfATubeHasNoMass)
{
  constexpr int SIDES = 24;
  constexpr double HEIGHT = 0.06;
  const RigidBodyShape shape = makeRigidBodyShape(tubeMesh(0.02f, 0.015f, static_cast<float>(HEIGHT), SIDES));
  const auto [outer_area, outer_moment] = polygon(0.02, SIDES);
  const auto [inner_area, inner_moment] = polygon(0.015, SIDES);
  const double area = outer_area - inner_area;
  const double polar = outer_moment - inner_moment;
  EXPECT_NEAR(shape.volume, area * HEIGHT, FLOAT_ROUNDING * area * HEIGHT);
  EXPECT_LT((shape.center_of_mass - Eigen::Vector3d(0, 0, HEIGHT / 2)).norm(), 1e-8);
  const double across = HEIGHT * polar / 2 + area * std::pow(HEIGHT, 3) / 12;
  expectInertia(shape, Eigen::Vector3d(across, across, HEIGHT * polar).asDiagonal());
}

TEST(RigidBody, meshWithoutAnInsideIsRefused)
{
  TriangleMesh open = box(0.08f, 0.04f, 0.02f);
  open.triangles.pop_back();
  expectWords(messageOf<ParameterError>([&] { makeRigidBodyShape(open); }), {"not closed", "3 of its edges"});
}
