// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <cmath>

#include "analytic_surfaces.hpp"
#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/part.hpp"

namespace bin_picking
{
namespace
{
using Eigen::AngleAxisd;
using Eigen::Translation3d;
using Eigen::Vector3d;

Pose turn(double angle_deg, const Vector3d& axis, const Vector3d& origin = Vector3d::Zero())
{
  return Pose(Translation3d(origin) * AngleAxisd(angle_deg * M_PI / 180, axis.normalized()) * Translation3d(-origin));
}

double angleBetweenRotations(const Pose& a, const Pose& b)
{
  return AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

bool isMember(const Pose& T, const std::vector<Pose>& group)
{
  for (const Pose& g : group)
    if ((g.matrix() - T.matrix()).norm() < 1e-9)
      return true;
  return false;
}

void expectGroup(const std::vector<Pose>& group, std::size_t size)
{
  ASSERT_EQ(group.size(), size);
  EXPECT_EQ(group.front().matrix(), Pose::Identity().matrix());
  for (const Pose& a : group)
  {
    EXPECT_TRUE(isMember(a.inverse(), group));
    for (const Pose& b : group)
      EXPECT_TRUE(isMember(a * b, group));
  }
}

TEST(Symmetry, closureHasTheOrderOfTheGroup)
{
  expectGroup(closeUnderComposition({}), 1);
  expectGroup(closeUnderComposition({turn(90, {0, 0, 1})}), 4);
  expectGroup(closeUnderComposition({turn(60, {0, 0, 1}), turn(180, {1, 0, 0})}), 12);   // hexagonal nut
  expectGroup(closeUnderComposition({turn(90, {0, 0, 1}), turn(90, {1, 0, 0})}), 24);    // cube
  expectGroup(closeUnderComposition({turn(120, {1, 1, 1}), turn(180, {0, 0, 1})}), 12);  // tetrahedron
  const double golden = (1 + std::sqrt(5.0)) / 2;
  expectGroup(closeUnderComposition({turn(72, {0, 1, golden}), turn(120, {1, 1, 1})}), 60);  // icosahedron
  expectGroup(closeUnderComposition({turn(3, {0, 0, 1})}), 120);
  const Vector3d origin(0.01, -0.02, 0.005);
  expectGroup(closeUnderComposition({turn(120, {1, 2, 3}, origin)}), 3);
}

TEST(Symmetry, closureRefusesWhatIsNoFiniteGroup)
{
  EXPECT_THROW(closeUnderComposition({turn(180, {0, 0, 1}), turn(180, {1, 0, 0.3})}), ParameterError);
  // Two parallel axes make a translation, and its multiples.
  EXPECT_THROW(closeUnderComposition({turn(180, {0, 0, 1}), turn(180, {0, 0, 1}, {0.01, 0, 0})}), ParameterError);
}

TEST(Symmetry, samplesTheAxisOfRevolution)
{
  Symmetry symmetry;
  EXPECT_TRUE(symmetry.trivial());
  EXPECT_EQ(symmetry.sampled(12).size(), 1u);
  const Vector3d origin(0.01, 0, 0);
  symmetry.continuous = Symmetry::Axis{Vector3d::UnitZ(), origin};
  symmetry.discrete.push_back(turn(180, {1, 0, 0}));
  EXPECT_FALSE(symmetry.trivial());
  const std::vector<Pose> samples = symmetry.sampled(12);
  expectGroup(samples, 24);
  for (const Pose& T : samples)
    EXPECT_LT((T * origin - origin).norm(), 1e-12);
  EXPECT_THROW(symmetry.sampled(0), ParameterError);
}

TEST(NearestEquivalent, findsTheElementThatWasApplied)
{
  std::mt19937 random(5);
  Symmetry cube;
  cube.discrete = closeUnderComposition({turn(90, {0, 0, 1}), turn(90, {1, 0, 0})});
  for (int i = 0; i < 50; ++i)
  {
    const Pose reference = test::randomPose(random, 1);
    // Less than half the smallest angle of the group, so that the nearest one is known.
    const Pose near = reference * turn(20, test::unitVector(random));
    const Pose& element = cube.discrete[random() % cube.discrete.size()];
    const Pose found = nearestEquivalent(near * element, reference, cube);
    EXPECT_LT((found.matrix() - near.matrix()).norm(), 1e-9);
  }
}

TEST(NearestEquivalent, turnsAboutTheAxisOfRevolution)
{
  std::mt19937 random(6);
  Symmetry tube;
  tube.continuous = Symmetry::Axis{Vector3d(1, 2, -1).normalized(), Vector3d(0.01, 0.02, 0)};
  tube.discrete.push_back(turn(180, tube.continuous->direction.unitOrthogonal(), tube.continuous->origin));
  for (int i = 0; i < 50; ++i)
  {
    const Pose reference = test::randomPose(random, 1);
    const Pose other = test::randomPose(random, 1);
    const Pose found = nearestEquivalent(other, reference, tube);
    // Equivalent: the point on the axis stays, the axis keeps its line.
    EXPECT_LT((found * tube.continuous->origin - other * tube.continuous->origin).norm(), 1e-12);
    const Vector3d axis_found = found.linear() * tube.continuous->direction;
    EXPECT_NEAR(std::abs(axis_found.dot(other.linear() * tube.continuous->direction)), 1, 1e-9);
    // Nearest: what remains is the angle between the axes, and no sample of the group does better.
    const double angle = angleBetweenRotations(found, reference);
    const double between = std::acos(std::abs(axis_found.dot(reference.linear() * tube.continuous->direction)));
    EXPECT_NEAR(angle, between, 1e-6);
    for (const Pose& element : tube.sampled(36))
      EXPECT_GE(angleBetweenRotations(other * element, reference), angle - 1e-9);
  }
}

TEST(NearestEquivalent, keepsThePoseWhereNothingIsNearer)
{
  Symmetry twofold;
  twofold.discrete.push_back(turn(180, {0, 0, 1}));
  const Pose T = turn(30, {1, 2, 3}, {0.1, 0.2, 0.3});
  EXPECT_EQ(nearestEquivalent(T, T, twofold).matrix(), T.matrix());
  // A quarter turn off, both are equally near: the first of the group wins.
  EXPECT_EQ(nearestEquivalent(T * turn(90, {0, 0, 1}), T, twofold).matrix(), (T * turn(90, {0, 0, 1})).matrix());
  EXPECT_EQ(nearestEquivalent(T * turn(-90, {0, 0, 1}), T, twofold).matrix(), (T * turn(-90, {0, 0, 1})).matrix());
}
}  // namespace
}  // namespace bin_picking
