// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/wall_timer.h>

#include <mutex>

#include "bin_picking_perception/robot/robot.hpp"

namespace bin_picking_ros
{
/// An arm without mass: goes where it is told, evenly, and publishes joint_states, from which robot_state_publisher
/// makes tf. It stands in for the driver of a robot in examples and tests.
class KinematicArm
{
public:
  /// Stands at the robot's home. \param speed of the fastest joint, rad/s
  /// \throws bin_picking::ParameterError the speed is not positive and finite
  KinematicArm(ros::NodeHandle nh, const bin_picking::Robot& robot, double speed);

  /// Moves all joints evenly; comes back when it is there. Between two waypoints of a grasp the joints' straight line
  /// bends away from the tool's by a little: for pictures only, a robot is commanded a straight move (movel).
  void moveTo(const bin_picking::Joints& target);

  void goHome() { moveTo(robot_.home); }

private:
  void publish();

  const bin_picking::Robot robot_;
  const double speed_;
  ros::Publisher publisher_;
  std::mutex mutex_;  ///< guards the joints
  bin_picking::Joints joints_;
  ros::WallTimer timer_;
};
}  // namespace bin_picking_ros
