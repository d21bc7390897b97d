// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "kinematic_arm.hpp"

#include <ros/init.h>
#include <ros/rate.h>
#include <sensor_msgs/JointState.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking_ros
{
namespace
{
constexpr double MOVING_RATE = 25;   // Hz
constexpr double STANDING_RATE = 5;  // Hz: who starts later sees the arm too

double checkedSpeed(double speed)
{
  if (!(speed > 0) || !std::isfinite(speed))
    throw bin_picking::ParameterError("the speed of the arm is " + std::to_string(speed) +
                                      " rad/s; it must be a positive number; set speed to 1 for about that of the "
                                      "robot, to more for faster");
  return speed;
}
}  // namespace

KinematicArm::KinematicArm(ros::NodeHandle nh, const bin_picking::Robot& robot, double speed)
    : robot_(robot),
      speed_(checkedSpeed(speed)),
      publisher_(nh.advertise<sensor_msgs::JointState>("joint_states", 10)),
      joints_(robot.home),
      timer_(
          nh.createWallTimer(ros::WallDuration(1 / STANDING_RATE), [this](const ros::WallTimerEvent&) { publish(); }))
{}

void KinematicArm::moveTo(const bin_picking::Joints& target)
{
  const bin_picking::Joints start = joints_;  // only this function changes them
  const double seconds = (target - start).cwiseAbs().maxCoeff() / speed_;
  const int num_steps = std::max(1, static_cast<int>(std::ceil(seconds * MOVING_RATE)));
  ros::WallRate rate(std::max(MOVING_RATE, num_steps / std::max(seconds, 1e-3)));
  for (int step = 1; step <= num_steps && ros::ok(); ++step)
  {
    rate.sleep();
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      joints_ = start + (target - start) * step / num_steps;
    }
    publish();
  }
}

void KinematicArm::publish()
{
  sensor_msgs::JointState state;
  state.header.stamp = ros::Time::now();
  state.name.assign(robot_.joint_names.begin(), robot_.joint_names.end());
  const std::lock_guard<std::mutex> lock(mutex_);
  state.position.assign(joints_.data(), joints_.data() + joints_.size());
  publisher_.publish(state);
}
}  // namespace bin_picking_ros
