// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "bin_picking_perception/robot/kinematics.hpp"

namespace bin_picking
{
namespace test
{
inline const std::vector<std::string>& robotNames()
{
  static const std::vector<std::string> NAMES = {"ur3", "ur3e", "ur5", "ur5e", "ur10", "ur10e"};
  return NAMES;
}

inline Robot configuredRobot(const std::string& name)
{
  return loadRobot(std::string(BIN_PICKING_SOURCE_DIR) + "/config/robots/" + name + ".yaml");
}

inline Joints degrees(double pan, double lift, double elbow, double wrist_1, double wrist_2, double wrist_3)
{
  Joints joints;
  joints << pan, lift, elbow, wrist_1, wrist_2, wrist_3;
  return joints * M_PI / 180;
}

/// Evenly within the limits.
inline Joints randomJoints(const Robot& robot, std::mt19937& random)
{
  Joints joints;
  for (int k = 0; k < 6; ++k)
    joints[k] = std::uniform_real_distribution<double>(robot.lower[k], robot.upper[k])(random);
  return joints;
}

/// What is said of a length must be true of it: the number of metres that follows "would be".
inline void expectTrueOfLength(const Robot& robot, bool too_far, const std::string& sentence)
{
  const std::string before = "would be ";
  const double length = std::stod(sentence.substr(sentence.find(before) + before.size()));
  if (too_far)
  {
    EXPECT_GT(length, std::abs(robot.dh[1].a + robot.dh[2].a)) << sentence;
    EXPECT_NE(sentence.find(" reaches "), std::string::npos) << sentence;
  }
  else if (sentence.find("fold closer") != std::string::npos)
    EXPECT_LT(length, std::abs(robot.dh[1].a - robot.dh[2].a)) << sentence;
  else
    EXPECT_LT(length, robot.dh[3].d) << sentence;
}

/// Largest difference of two poses' entries: metres and (small) radians.
inline double difference(const Pose& a, const Pose& b) { return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff(); }
}  // namespace test
}  // namespace bin_picking
