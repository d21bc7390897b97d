// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

#include "bin_picking_perception/common/oriented_points.hpp"

namespace bin_picking
{
/// Angles of shoulder_pan, shoulder_lift, elbow, wrist_1, wrist_2, wrist_3; radians.
using Joints = Eigen::Matrix<double, 6, 1>;

/// One link after Denavit and Hartenberg (standard form): turn by the joint about z, shift by d along z, by a along the
/// new x, turn by alpha about it. Metres and radians.
struct DhRow
{
  double a = 0;
  double d = 0;
  double alpha = 0;
};

/// An arm of Universal Robots' build.
///
/// Frames: `base` is the frame of the robot's controller, in which its pendant shows poses; `base_link` is the root of
/// the ROS description, the same frame turned by half a turn about Z. Whoever takes one for the other sends the arm to
/// the opposite side of its base. `tool0` is the flange, Z out of it.
struct Robot
{
  std::string name;
  std::array<std::string, 6> joint_names;
  std::array<DhRow, 6> dh;
  Joints lower = Joints::Zero();  ///< limits of the joints
  Joints upper = Joints::Zero();
  Joints home = Joints::Zero();  ///< where the arm waits: of several solutions, the one nearest to it is preferred
  Pose T_base_link_base = Pose::Identity();
};

/// Reads config/robots/<robot>.yaml.
/// \throws FileError missing file; unknown key; not six joints; limits or home that do not fit each other; lengths or
/// twists that are not those of an arm of Universal Robots' build, for which the inverse kinematics hold
Robot loadRobot(const std::string& path);

/// What keeps the closed-form kinematics from holding for a robot, as a sentence; empty: nothing.
std::string geometryFault(const Robot& robot);
}  // namespace bin_picking
