// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include "bin_picking_perception/common/error.hpp"
#include "robots.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using test::configuredRobot;
using test::expectWords;
using test::messageOf;
using test::TemporaryFolder;

std::string replaced(std::string text, const std::string& what, const std::string& by)
{
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

TEST(RobotFile, readsTheUr5e)
{
  const Robot robot = configuredRobot("ur5e");
  EXPECT_EQ(robot.name, "UR5e");
  EXPECT_EQ(robot.joint_names[2], "elbow_joint");
  EXPECT_DOUBLE_EQ(robot.dh[0].d, 0.1625);
  EXPECT_DOUBLE_EQ(robot.dh[1].a, -0.425);
  EXPECT_EQ(robot.dh[3].alpha, M_PI_2);  // exactly: the kinematics rely on right angles
  EXPECT_NEAR(robot.upper[0], 2 * M_PI, 1e-12);
  EXPECT_NEAR(robot.lower[2], -M_PI, 1e-12);
  EXPECT_LT((robot.T_base_link_base.linear() - Eigen::Vector3d(-1, -1, 1).asDiagonal().toDenseMatrix()).norm(), 1e-12);
}

// Above a bin in front: at x of half a metre or so in ROS' frame, gripper straight down.
TEST(RobotFile, homesLookDownInFrontOfTheArm)
{
  for (const std::string& name : test::robotNames())
  {
    const Robot robot = configuredRobot(name);
    const Pose T_base_link_tool0 = robot.T_base_link_base * Kinematics(robot).forward(robot.home);
    EXPECT_LT((T_base_link_tool0.linear().col(2) + Eigen::Vector3d::UnitZ()).norm(), 1e-9) << name;
    EXPECT_GT(T_base_link_tool0.translation().x(), 0.2) << name;
    EXPECT_GT(T_base_link_tool0.translation().z(), 0.2) << name;
  }
}

TEST(RobotFile, namesWhatIsWrong)
{
  const TemporaryFolder folder;
  const std::string good = test::readFile(std::string(BIN_PICKING_SOURCE_DIR) + "/config/robots/ur5e.yaml");
  const auto error = [&](const std::string& what, const std::string& by) {
    const std::string path = folder.write("robot.yaml", replaced(good, what, by));
    return messageOf<FileError>([&] { loadRobot(path); });
  };
  expectWords(messageOf<FileError>([&] { loadRobot(folder.path("missing.yaml")); }), {"missing.yaml"});
  expectWords(error("format: 1", "format: 2"), {"robot.yaml:", "format is 2"});
  expectWords(error("alpha: 90deg", "alfa: 90deg"), {"robot.yaml:", "did you mean 'alpha'?"});
  expectWords(error("d: 0.1333", "d: 0.1333kg"), {"robot.yaml:", "'d'"});
  expectWords(error("alpha: -90deg", "alpha: -89.99deg"), {"robot.yaml:", "joint 5", "-89.99", "calibration"});
  expectWords(error("home: 90deg", "home: 190deg"), {"robot.yaml:", "'home'", "elbow_joint", "3.14"});
  expectWords(error("  - {name: elbow_joint", "  #"), {"robot.yaml:", "5 'joints'", "6"});
}
}  // namespace
}  // namespace bin_picking
