// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/robot/reach.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bin_picking_perception/common/error.hpp"
#include "robots.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using test::configuredRobot;
using test::difference;
using test::expectWords;
using test::messageOf;

/// Straight down at a place in ROS' frame, the fingers closing along a direction at `angle`.
Pose downAt(const Robot& robot, double x, double y, double z, double angle = 0, double tilt = 0)
{
  Pose T_base_link_tool0 = Pose::Identity();
  T_base_link_tool0.linear() =
      (Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(M_PI - tilt, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  T_base_link_tool0.translation() = Eigen::Vector3d(x, y, z);
  return robot.T_base_link_base.inverse() * T_base_link_tool0;
}

/// Pre-grasp 8 cm back along the approach, retreat 12 cm up.
ReachRequest pick(const Pose& T_base_grasp)
{
  Pose pre = T_base_grasp, retreat = T_base_grasp;
  pre.translation() -= 0.08 * T_base_grasp.linear().col(2);
  retreat.translation().z() += 0.12;
  return {{pre, T_base_grasp, retreat}};
}

class ReachOfUr5e : public testing::Test
{
protected:
  const Robot robot_ = configuredRobot("ur5e");
  const Kinematics kinematics_{robot_};
};

TEST_F(ReachOfUr5e, picksInABinInFrontAreReached)
{
  for (double x = 0.35; x <= 0.6; x += 0.05)
    for (double y = -0.2; y <= 0.2; y += 0.1)
      for (double angle = 0; angle < 2 * M_PI; angle += 0.7)
      {
        const ReachRequest request = pick(downAt(robot_, x, y, 0.2, angle, 0.3 * std::sin(angle)));
        const Reach result = reach(kinematics_, request);
        ASSERT_EQ(result.failure, Reach::Failure::None) << result.reason << " at " << x << ' ' << y << ' ' << angle;
        EXPECT_TRUE(result.reason.empty());
        ASSERT_EQ(result.joints.size(), 3u);
        for (std::size_t w = 0; w < 3; ++w)
          EXPECT_LT(difference(kinematics_.forward(result.joints[w]), request.waypoints_base_tool0[w]), 1e-9);
      }
}

// Followed on a grid ten times as fine as the one that was looked at: the flange stays on its line, no joint jumps.
TEST_F(ReachOfUr5e, jointsAreContinuousOnTheStraightLines)
{
  const ReachRequest request = pick(downAt(robot_, 0.45, -0.15, 0.2, 1.0, 0.4));
  const Reach result = reach(kinematics_, request);
  ASSERT_EQ(result.failure, Reach::Failure::None) << result.reason;
  Joints joints = result.joints[0];
  for (std::size_t w = 1; w < 3; ++w)
  {
    const Pose from = request.waypoints_base_tool0[w - 1], to = request.waypoints_base_tool0[w];
    for (int i = 1; i <= 240; ++i)
    {
      Pose pose = from;
      pose.translation() += i / 240.0 * (to.translation() - from.translation());
      double smallest = std::numeric_limits<double>::infinity();
      Joints next = joints;
      for (const Joints& solution : kinematics_.inverse(pose, joints))
        if ((solution - joints).norm() < smallest)
        {
          smallest = (solution - joints).norm();
          next = solution;
        }
      ASSERT_LT(smallest, 0.02);
      joints = next;
    }
    EXPECT_LT((joints - result.joints[w]).cwiseAbs().maxCoeff(), 1e-9);  // the same branch and the same turn arrives
  }
}

TEST_F(ReachOfUr5e, theBranchNearestToHomeIsTaken)
{
  Pose pre = kinematics_.forward(robot_.home);
  const Reach result = reach(kinematics_, {{pre}});
  ASSERT_EQ(result.failure, Reach::Failure::None) << result.reason;
  EXPECT_LT((result.joints[0] - robot_.home).cwiseAbs().maxCoeff(), 1e-9);
}

// Within its limits a joint may have to turn the long way round: then another branch is nearer.
TEST_F(ReachOfUr5e, theLimitsCountForWhatIsNearest)
{
  Robot robot = robot_;
  robot.lower[5] = -M_PI;
  robot.upper[5] = M_PI;
  robot.home = test::degrees(0, -90, 90, -90, -90, 170);
  const Kinematics kinematics(robot);
  // Without limits 30 degrees from home by wrist_3 alone; with them 330.
  const Pose pose = kinematics.forward(test::degrees(0, -90, 90, -90, -90, 200));
  double nearest = std::numeric_limits<double>::infinity();
  for (const Joints& joints : kinematics.inverse(pose))
    nearest = std::min(nearest, (joints - robot.home).squaredNorm());
  ASSERT_LT(nearest, std::pow(329 * M_PI / 180, 2));
  const Reach result = reach(kinematics, {{pose}});
  ASSERT_EQ(result.failure, Reach::Failure::None) << result.reason;
  EXPECT_NEAR((result.joints[0] - robot.home).squaredNorm(), nearest, 1e-9);
}

TEST_F(ReachOfUr5e, theDistanceThatIsToldIsThatOfTheBranch)
{
  int told = 0;
  for (double x = 0.1; x <= 1.0; x += 0.02)
    for (double z = -0.2; z <= 0.8; z += 0.1)
      for (const double tilt : {-0.5, 0.0, 0.5})
      {
        const Reach result = reach(kinematics_, pick(downAt(robot_, x, 0.1, z, 0.4, tilt)));
        if (result.failure != Reach::Failure::OutOfReach && result.failure != Reach::Failure::NoSolution)
          continue;
        ++told;
        test::expectTrueOfLength(robot_, result.failure == Reach::Failure::OutOfReach, result.reason);
      }
  EXPECT_GT(told, 100);
}

TEST_F(ReachOfUr5e, tooFarNamesWaypointAndDistances)
{
  const Reach result = reach(kinematics_, pick(downAt(robot_, 0.95, 0, 0.2)));
  EXPECT_EQ(result.failure, Reach::Failure::OutOfReach);
  EXPECT_TRUE(result.joints.empty());
  expectWords(result.reason, {"At the pre-grasp", "from the shoulder", "the UR5e reaches 0.817 m"});
  // Here only the end of the retreat is too far.
  ReachRequest request = pick(downAt(robot_, 0.6, 0, 0.2));
  request.waypoints_base_tool0[2].translation().z() += 0.6;
  const Reach late = reach(kinematics_, request);
  EXPECT_NE(late.failure, Reach::Failure::None);
  EXPECT_EQ(late.waypoint, 2u);
  expectWords(late.reason, {"retreat"});
}

TEST_F(ReachOfUr5e, tooNearTheBaseHasNoSolution)
{
  const Reach result = reach(kinematics_, {{downAt(robot_, 0.08, 0.03, 0.4)}});
  EXPECT_EQ(result.failure, Reach::Failure::NoSolution);
  expectWords(result.reason, {"waypoint 1", "vertical axis", "0.133 m"});
}

TEST_F(ReachOfUr5e, singularitiesAreRefusedWithTheirAngle)
{
  // The flange horizontal, its axis along those of shoulder_lift and elbow: wrist_2 is 0.
  const Pose at_wrist = kinematics_.forward(test::degrees(0, -80, 95, -15, 3, 0));
  Robot robot = robot_;
  robot.lower[0] = -1;  // not with the shoulder behind the wrist, which would do
  robot.upper[0] = 1;
  const Kinematics kinematics(robot);
  Reach result = reach(kinematics, {{at_wrist}});
  EXPECT_EQ(result.failure, Reach::Failure::Singular);
  expectWords(result.reason, {"wrist_2_joint", "3.0 deg", "min_wrist_angle"});
  ReachParameters parameters;
  parameters.min_wrist_angle = 0.05;
  EXPECT_EQ(reach(kinematics, {{at_wrist}}, parameters).failure, Reach::Failure::None);

  const Pose stretched = kinematics_.forward(test::degrees(0, -30, 4, -60, -90, 0));
  result = reach(kinematics_, {{stretched}});
  EXPECT_EQ(result.failure, Reach::Failure::Singular);
  expectWords(result.reason, {"elbow", "4.0 deg", "min_elbow_angle"});
}

// Both ends are fine, but the straight line between them passes the base: the wrist comes next to its axis.
TEST_F(ReachOfUr5e, theWayBetweenIsLookedAt)
{
  const Reach result = reach(kinematics_, {{downAt(robot_, 0.5, 0.02, 0.4), downAt(robot_, -0.5, 0.02, 0.4)}});
  EXPECT_NE(result.failure, Reach::Failure::None);
  EXPECT_EQ(result.waypoint, 1u);
  expectWords(result.reason, {"% of the way from waypoint 1 to waypoint 2"});
}

TEST_F(ReachOfUr5e, jointLimitsAreNamed)
{
  Robot robot = robot_;
  robot.lower[0] = -0.2;
  robot.upper[0] = 0.2;
  const Reach result = reach(Kinematics(robot), pick(downAt(robot, 0.0, 0.5, 0.2)));
  EXPECT_EQ(result.failure, Reach::Failure::JointLimit);
  expectWords(result.reason, {"shoulder_pan_joint", "-11.5 deg", "11.5 deg"});
}

TEST_F(ReachOfUr5e, aJumpOfAJointIsRefused)
{
  ReachParameters parameters;
  parameters.path_step = 0.05;
  parameters.max_joint_step = 0.03;
  const Reach result = reach(kinematics_, pick(downAt(robot_, 0.45, 0, 0.2)), parameters);
  EXPECT_EQ(result.failure, Reach::Failure::Discontinuous);
  expectWords(result.reason, {"neighbouring poses", "1.7 deg", "max_joint_step"});
}

// A line in ROS' frame taken for one in the controller's has the arm reach behind itself.
TEST_F(ReachOfUr5e, framesMustNotBeMixedUp)
{
  const ReachRequest request = pick(downAt(robot_, 0.5, 0.1, 0.2));
  ReachRequest mixed_up = request;
  for (Pose& pose : mixed_up.waypoints_base_tool0)
    pose = robot_.T_base_link_base * pose;
  const Reach right = reach(kinematics_, request), wrong = reach(kinematics_, mixed_up);
  ASSERT_EQ(right.failure, Reach::Failure::None) << right.reason;
  EXPECT_LT(std::abs(right.joints[1][0]), 1.0);
  ASSERT_EQ(wrong.failure, Reach::Failure::None) << wrong.reason;  // nothing but the joints shows the mistake
  EXPECT_GT((right.joints[1] - wrong.joints[1]).cwiseAbs().maxCoeff(), 1.0);
}

TEST_F(ReachOfUr5e, refusesPosesThatAreNone)
{
  expectWords(messageOf<ParameterError>([&] { reach(kinematics_, {}); }), {"no waypoint"});
  ReachRequest request = pick(downAt(robot_, 0.5, 0, 0.2));
  request.waypoints_base_tool0[1].translation().y() = std::numeric_limits<double>::quiet_NaN();
  expectWords(messageOf<ParameterError>([&] { reach(kinematics_, request); }), {"waypoint 2", "not finite"});
}

// A step of 0 or backwards would look at the ends of the way only.
TEST_F(ReachOfUr5e, refusesParametersOutOfTheirRange)
{
  const ReachRequest request = pick(downAt(robot_, 0.5, 0, 0.2));
  for (const double step : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
  {
    ReachParameters parameters;
    parameters.path_step = step;
    expectWords(messageOf<ParameterError>([&] { reach(kinematics_, request, parameters); }), {"path_step"});
  }
  ReachParameters parameters;
  parameters.min_wrist_angle = std::numeric_limits<double>::quiet_NaN();
  expectWords(messageOf<ParameterError>([&] { reach(kinematics_, request, parameters); }), {"min_wrist_angle"});
}

TEST_F(ReachOfUr5e, parametersAreDocumentedAndChecked)
{
  ReachParameters parameters;
  checkRanges(parameters);
  setParametersFromYaml(visitor(parameters), "min_wrist_angle: 20deg\npath_step: 2mm\n", "reach.yaml");
  EXPECT_NEAR(parameters.min_wrist_angle, 0.349066, 1e-6);
  EXPECT_DOUBLE_EQ(parameters.path_step, 0.002);
  ReachParameters copy;
  setParametersFromYaml(visitor(copy), toYaml(visitor(parameters)), "dump");
  EXPECT_EQ(toYaml(visitor(copy)), toYaml(visitor(parameters)));
}

TEST_F(ReachOfUr5e, documentationHasEveryParameter)
{
  ReachParameters parameters;
  const std::string page = test::readFile(std::string(BIN_PICKING_SOURCE_DIR) + "/docs/robots.md");
  const std::string table = toMarkdown(visitor(parameters));
  EXPECT_NE(page.find(table), std::string::npos) << "docs/robots.md must have this table:\n" << table;
}
}  // namespace
}  // namespace bin_picking
