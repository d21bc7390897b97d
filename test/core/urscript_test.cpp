// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/robot/urscript.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "bin_picking_perception/common/error.hpp"
#include "robots.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using test::difference;
using test::expectWords;
using test::messageOf;

Pose poseOf(double x, double y, double z, double angle, const Eigen::Vector3d& axis)
{
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(x, y, z);
  return pose;
}

TEST(UrScript, writesWhatTheControllerReads)
{
  EXPECT_EQ(toUrScript(Pose::Identity()), "p[0, 0, 0, 0, 0, 0]");
  EXPECT_EQ(toUrScript(poseOf(0.4, -0.1, 0.25, M_PI_2, Eigen::Vector3d::UnitZ())),
            "p[0.4, -0.1, 0.25, 0, 0, 1.5707963268]");
  EXPECT_EQ(toUrScriptMove(poseOf(0.4, -0.1, 1e-7, M_PI, Eigen::Vector3d::UnitX()), 0.5, 0.1),
            "movel(p[0.4, -0.1, 0.0000001, 3.1415926536, 0, 0], a=0.5, v=0.1)");
}

TEST(UrScript, readsBackWhatItWrites)
{
  std::mt19937 random(4);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int i = 0; i < 1000; ++i)
  {
    const Eigen::Vector3d axis(number(random), number(random), number(random));
    const Pose pose = poseOf(number(random), number(random), number(random), M_PI * number(random), axis);
    EXPECT_LT(difference(fromUrScript(toUrScript(pose)), pose), 1e-9);
    EXPECT_LT(difference(fromUrScript(toUrScriptMove(pose)), pose), 1e-9);
  }
}

// The gripper straight down is a half turn about a horizontal axis: the common case, and the one in which the axis can
// be read with either sign.
TEST(UrScript, halfTurnsComeBackAndHaveOneForm)
{
  for (int i = 0; i < 360; ++i)
  {
    const double a = i * M_PI / 180;
    const Eigen::Vector3d axis(std::cos(a), std::sin(a), 0);
    for (const double angle : {M_PI, M_PI - 1e-8, M_PI - 1e-12})
    {
      const Pose pose = poseOf(0.1, 0.2, 0.3, angle, axis);
      EXPECT_LT(difference(fromUrScript(toUrScript(pose)), pose), 1e-9) << i;
    }
    const Eigen::Matrix3d half = Eigen::AngleAxisd(M_PI, axis).toRotationMatrix();
    EXPECT_NEAR(rotationVector(half).norm(), M_PI, 1e-9);
    EXPECT_LT((rotationVector(half) - rotationVector(half.transpose())).norm(), 1e-7) << i;
  }
}

TEST(UrScript, refusesWhatIsNoPose)
{
  Pose broken = Pose::Identity();
  broken.translation().x() = std::numeric_limits<double>::quiet_NaN();
  expectWords(messageOf<ParameterError>([&] { toUrScript(broken); }), {"not finite"});
  expectWords(messageOf<ParameterError>([&] { toUrScriptMove(Pose::Identity(), 0, 1); }), {"acceleration", "positive"});
  for (const char* text : {"", "p[]", "p[1, 2, 3, 4, 5]", "p[1, 2, 3, 4, 5, six]", "p[1; 2; 3; 4; 5; 6]"})
    expectWords(messageOf<ParameterError>([&] { fromUrScript(text); }), {"six finite numbers"});
}
}  // namespace
}  // namespace bin_picking
