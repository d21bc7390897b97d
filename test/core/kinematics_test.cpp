// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/robot/kinematics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <limits>

#include "bin_picking_perception/common/error.hpp"
#include "robots.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using test::configuredRobot;
using test::degrees;
using test::difference;
using test::expectWords;
using test::messageOf;
using test::randomJoints;
using test::robotNames;

KDL::Chain kdlChain(const Robot& robot)
{
  KDL::Chain chain;
  for (const DhRow& row : robot.dh)
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ), KDL::Frame::DH(row.a, row.alpha, row.d, 0)));
  return chain;
}

KDL::JntArray kdlJoints(const Joints& joints)
{
  KDL::JntArray array(6);
  array.data = joints;
  return array;
}

Pose fromKdl(const KDL::Frame& frame)
{
  Pose pose = Pose::Identity();
  for (int i = 0; i < 3; ++i)
  {
    pose.translation()[i] = frame.p[i];
    for (int j = 0; j < 3; ++j)
      pose.linear()(i, j) = frame.M(i, j);
  }
  return pose;
}

KDL::Frame toKdl(const Pose& pose)
{
  KDL::Frame frame;
  for (int i = 0; i < 3; ++i)
  {
    frame.p[i] = pose.translation()[i];
    for (int j = 0; j < 3; ++j)
      frame.M(i, j) = pose.linear()(i, j);
  }
  return frame;
}

/// Largest difference of joints, whole turns left out.
double jointDifference(const Joints& a, const Joints& b)
{
  double largest = 0;
  for (int k = 0; k < 6; ++k)
    largest = std::max(largest, std::abs(std::remainder(a[k] - b[k], 2 * M_PI)));
  return largest;
}

double nearest(const std::vector<Joints>& solutions, const Joints& joints)
{
  double smallest = std::numeric_limits<double>::infinity();
  for (const Joints& solution : solutions)
    smallest = std::min(smallest, jointDifference(solution, joints));
  return smallest;
}

bool withinLimits(const Robot& robot, const Joints& joints)
{
  return (joints.array() >= robot.lower.array()).all() && (joints.array() <= robot.upper.array()).all();
}

TEST(Kinematics, forwardAgreesWithKdl)
{
  std::mt19937 random(1);
  for (const std::string& name : robotNames())
  {
    const Kinematics kinematics(configuredRobot(name));
    const KDL::Chain chain = kdlChain(kinematics.robot());
    KDL::ChainFkSolverPos_recursive solver(chain);
    for (int i = 0; i < 1000; ++i)
    {
      const Joints joints = randomJoints(kinematics.robot(), random);
      KDL::Frame frame;
      ASSERT_GE(solver.JntToCart(kdlJoints(joints), frame), 0);
      EXPECT_LT(difference(kinematics.forward(joints), fromKdl(frame)), 1e-9) << name;
    }
  }
}

// All joints at 0: the maker's drawing shows the arm stretched to -x of `base`, the flange looking to -y.
TEST(Kinematics, stretchedArmIsWhereTheMakerDrawsIt)
{
  const Robot robot = configuredRobot("ur5e");
  const Kinematics kinematics(robot);
  const Pose T = kinematics.forward(Joints::Zero());
  EXPECT_LT((T.translation() - Eigen::Vector3d(-0.8172, -0.2329, 0.0628)).norm(), 1e-9);
  EXPECT_LT((T.linear().col(2) + Eigen::Vector3d::UnitY()).norm(), 1e-9);
  const Pose T_base_link_tool0 = robot.T_base_link_base * T;
  EXPECT_LT((T_base_link_tool0.translation() - Eigen::Vector3d(0.8172, 0.2329, 0.0628)).norm(), 1e-9);
}

// The trap of the two frames: the pose that is meant in base_link, given as one in base, is another way to stand.
TEST(Kinematics, baseAndBaseLinkMustNotBeMixedUp)
{
  const Robot robot = configuredRobot("ur5e");
  const Kinematics kinematics(robot);
  const Joints joints = degrees(20, -80, 95, -105, -90, 35);
  const Pose T_base_tool0 = kinematics.forward(joints);
  const Pose T_base_link_tool0 = robot.T_base_link_base * T_base_tool0;
  EXPECT_GT(T_base_link_tool0.translation().x(), 0.3);  // in front in ROS' frame
  EXPECT_LT(T_base_tool0.translation().x(), -0.3);
  EXPECT_LT(nearest(kinematics.inverse(robot.T_base_link_base.inverse() * T_base_link_tool0), joints), 1e-9);
  // Mixed up, every solution has the arm look to the other side.
  const std::vector<Joints> mixed_up = kinematics.inverse(T_base_link_tool0);
  ASSERT_FALSE(mixed_up.empty());
  EXPECT_GT(nearest(mixed_up, joints), 0.5);
  Joints turned = joints;
  turned[0] += M_PI;
  EXPECT_LT(nearest(mixed_up, turned), 1e-9);
}

TEST(Kinematics, inverseIsExactAndHasTheSeed)
{
  std::mt19937 random(2);
  for (const std::string& name : robotNames())
  {
    const Kinematics kinematics(configuredRobot(name));
    for (int i = 0; i < 2000; ++i)
    {
      const Joints joints = randomJoints(kinematics.robot(), random);
      const Pose T = kinematics.forward(joints);
      const std::vector<Joints> solutions = kinematics.inverse(T);
      ASSERT_FALSE(solutions.empty());
      EXPECT_LE(solutions.size(), 8u);
      EXPECT_LT(nearest(solutions, joints), 1e-6) << name << ' ' << joints.transpose();
      for (std::size_t k = 0; k < solutions.size(); ++k)
      {
        EXPECT_LT(difference(kinematics.forward(solutions[k]), T), 1e-9) << name << ' ' << joints.transpose();
        EXPECT_TRUE(withinLimits(kinematics.robot(), solutions[k]));
        for (std::size_t l = 0; l < k; ++l)
          EXPECT_GT(jointDifference(solutions[k], solutions[l]), 1e-8);
      }
    }
  }
}

TEST(Kinematics, aPoseInTheMiddleOfTheReachHasEightWays)
{
  const Kinematics kinematics(configuredRobot("ur5e"));
  EXPECT_EQ(kinematics.inverse(kinematics.forward(kinematics.robot().home)).size(), 8u);
}

// Levenberg and Marquardt's method from a start next to one of our solutions has to stay there.
TEST(Kinematics, inverseAgreesWithKdl)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> shift(-0.05, 0.05);
  const Kinematics kinematics(configuredRobot("ur5e"));
  const KDL::Chain chain = kdlChain(kinematics.robot());
  KDL::ChainIkSolverPos_LMA solver(chain, 1e-12, 1000, 1e-15);
  int compared = 0;
  for (int i = 0; i < 200; ++i)
  {
    const Joints joints = randomJoints(kinematics.robot(), random);
    const SingularityMargin margin = kinematics.singularityMargin(joints);
    if (margin.wrist < 0.3 || margin.elbow < 0.3 || margin.shoulder < 0.1)
      continue;
    Joints start = joints;
    for (int k = 0; k < 6; ++k)
      start[k] += shift(random);
    const Pose T = kinematics.forward(joints);
    KDL::JntArray found(6);
    if (solver.CartToJnt(kdlJoints(start), toKdl(T), found) < 0)
      continue;
    ++compared;
    EXPECT_LT(nearest(kinematics.inverse(T), found.data), 1e-5);  // it stops at about 1e-6
  }
  EXPECT_GT(compared, 50);
}

TEST(Kinematics, singularPosesHaveFiniteExactSolutions)
{
  for (const std::string& name : robotNames())
  {
    const Kinematics kinematics(configuredRobot(name));
    std::vector<Joints> singular = {Joints::Zero(),
                                    degrees(10, -60, 70, -100, 0, 30),
                                    degrees(10, -60, 70, -100, 180, 30),
                                    degrees(10, -60, 0, -30, -90, 30),
                                    degrees(10, -60, 0, -30, 0, 30),
                                    degrees(10, -60, 180, -30, 50, 30)};
    for (const Joints& joints : singular)
    {
      const Pose T = kinematics.forward(joints);
      const std::vector<Joints> solutions = kinematics.inverse(T, joints);
      EXPECT_FALSE(solutions.empty()) << name << ' ' << joints.transpose();
      EXPECT_LT(nearest(solutions, joints), 1e-6) << name << ' ' << joints.transpose();
      for (const Joints& solution : solutions)
      {
        EXPECT_TRUE(solution.allFinite());
        EXPECT_LT(difference(kinematics.forward(solution), T), 1e-9) << name << ' ' << joints.transpose();
      }
    }
  }
}

// The end of the forearm straight above the shoulder, the wrist's link vertical: shoulder_pan has nothing to turn.
TEST(Kinematics, shoulderSingularityIsMet)
{
  const Kinematics kinematics(configuredRobot("ur5e"));
  const auto& dh = kinematics.robot().dh;
  Joints joints = degrees(10, 0, 150, 0, -90, 30);
  joints[1] = M_PI_2 - std::atan2(dh[2].a * std::sin(joints[2]), dh[1].a + dh[2].a * std::cos(joints[2]));
  joints[3] = -joints[1] - joints[2];
  ASSERT_LT(kinematics.singularityMargin(joints).shoulder, 1e-12);
  const Pose T = kinematics.forward(joints);
  const std::vector<Joints> solutions = kinematics.inverse(T, joints);
  EXPECT_LT(nearest(solutions, joints), 1e-6);
  EXPECT_LE(solutions.size(), 4u);  // before and behind the shoulder are one
  for (const Joints& solution : solutions)
    EXPECT_LT(difference(kinematics.forward(solution), T), 1e-9);
}

TEST(Kinematics, turnsAreThoseNextToTheReference)
{
  const Robot robot = configuredRobot("ur5e");
  const Kinematics kinematics(robot);
  const Joints joints = degrees(170, -80, 95, -105, -90, 300);
  const Pose T = kinematics.forward(joints);
  const auto turns = [&](const Joints& reference) {
    double smallest = std::numeric_limits<double>::infinity();
    for (const Joints& solution : kinematics.inverse(T, reference))
      smallest = std::min(smallest, (solution - joints).cwiseAbs().maxCoeff());
    return smallest;
  };
  EXPECT_LT(turns(joints), 1e-9);
  bool found = false;
  for (const Joints& solution : kinematics.inverse(T, degrees(170, 0, 0, 0, 0, 200)))
    if (jointDifference(solution, joints) < 1e-9)
    {
      found = true;
      EXPECT_NEAR(solution[5], joints[5], 1e-9);
    }
  EXPECT_TRUE(found);
  const std::vector<Joints> all = kinematics.inverse(T, Joints::Zero());
  ASSERT_EQ(all.size(), 8u);
  for (const Joints& solution : all)
    EXPECT_LE(solution.cwiseAbs().maxCoeff(), M_PI + 1e-9);
  // Nearest to a reference beyond the limits, but within them: the elbow's are half a turn, the others' a whole one.
  for (const double beyond : {3 * M_PI, 5 * M_PI, -9 * M_PI})
  {
    const std::vector<Joints> solutions = kinematics.inverse(T, Joints::Constant(beyond));
    ASSERT_EQ(solutions.size(), all.size()) << beyond;
    for (const Joints& solution : solutions)
    {
      EXPECT_TRUE(withinLimits(robot, solution));
      for (const int joint : {0, 1, 3, 4, 5})
        EXPECT_GE(std::copysign(1, beyond) * solution[joint], -1e-9) << beyond;
    }
  }
}

TEST(Kinematics, solutionsBeyondTheLimitsAreLeftOut)
{
  Robot robot = configuredRobot("ur5e");
  robot.lower[2] = 0;  // only one way to bend the elbow
  const Kinematics kinematics(robot);
  const std::vector<Joints> solutions = kinematics.inverse(kinematics.forward(robot.home));
  EXPECT_EQ(solutions.size(), 4u);
  for (const Joints& solution : solutions)
    EXPECT_GE(solution[2], 0);
}

TEST(Kinematics, saysWhyAPoseIsOutOfReach)
{
  const Kinematics kinematics(configuredRobot("ur5e"));
  Pose T = kinematics.forward(kinematics.robot().home);
  T.translation().x() -= 0.6;
  EXPECT_TRUE(kinematics.inverse(T).empty());
  EXPECT_TRUE(kinematics.fault(T).too_far);
  expectWords(kinematics.fault(T).sentence, {"from the shoulder", "the UR5e reaches 0.817 m"});
  T.translation() = Eigen::Vector3d(0.05, 0.02, 0.3);
  EXPECT_TRUE(kinematics.inverse(T).empty());
  EXPECT_FALSE(kinematics.fault(T).too_far);
  expectWords(kinematics.fault(T).sentence, {"from the vertical axis", "0.133 m"});
}

// At the edges of what it reaches, an arm may take a pose with one branch and not with another.
TEST(Kinematics, whatIsSaidOfABranchIsTrueOfIt)
{
  Robot compact = configuredRobot("ur5e");  // some of its branches are too short where others are too long
  compact.dh[1].a = -0.30;
  compact.dh[2].a = -0.12;
  compact.dh[4].d = 0.3;
  std::mt19937 random(5);
  for (const Robot& robot : {configuredRobot("ur5e"), compact})
  {
    const Kinematics kinematics(robot);
    int beside_others = 0;
    int without_any = 0;
    for (int i = 0; i < 3000; ++i)
    {
      Pose T = kinematics.forward(randomJoints(robot, random));
      T.translation() *= 1.1;
      int taken = 0;
      for (int k = 0; k < Kinematics::NUM_BRANCHES; ++k)
        taken += kinematics.branch(k, T, robot.home).has_value();
      for (int k = 0; k < Kinematics::NUM_BRANCHES; ++k)
        if (!kinematics.branch(k, T, robot.home))
        {
          const Kinematics::Fault fault = kinematics.fault(k, T, robot.home);
          test::expectTrueOfLength(robot, fault.too_far, fault.sentence);
          beside_others += taken > 0;
        }
      if (taken > 0)
        continue;
      const Kinematics::Fault fault = kinematics.fault(T);
      test::expectTrueOfLength(robot, fault.too_far, fault.sentence);
      ++without_any;
    }
    EXPECT_GT(beside_others, 100);
    EXPECT_GT(without_any, 100);
  }
}

TEST(Kinematics, refusesPosesAndGeometriesThatItCannotServe)
{
  const Kinematics kinematics(configuredRobot("ur5e"));
  Pose T = Pose::Identity();
  T.translation().x() = std::numeric_limits<double>::quiet_NaN();
  expectWords(messageOf<ParameterError>([&] { kinematics.inverse(T); }), {"not finite"});
  T = Pose::Identity();
  T.linear() *= 1.001;
  expectWords(messageOf<ParameterError>([&] { kinematics.inverse(T); }), {"not rigid"});
  Robot robot = configuredRobot("ur5e");
  robot.dh[1].d = 0.1;
  expectWords(messageOf<ParameterError>([&] { Kinematics{robot}; }), {"joint 2", "'d' of 0.100 m"});
}
}  // namespace
}  // namespace bin_picking
