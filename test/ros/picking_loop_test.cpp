// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// The example programs ask, grip and report, and their account is true; the picture of the arm is the arm.
#include <bin_picking_perception/TakePart.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <array>
#include <cstdio>
#include <string>

#include "bin_picking_perception/robot/kinematics.hpp"
#include "bin_picking_perception/robot/urscript.hpp"
#include "pose_conversion.hpp"

namespace
{
using bin_picking_perception::TakePart;

struct Run
{
  int exit_code = -1;
  std::string output;
};

Run run(const std::string& command)
{
  Run result;
  FILE* const pipe = popen((command + " 2>&1").c_str(), "r");
  if (!pipe)
    return result;
  std::array<char, 256> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe))
    result.output += buffer.data();
  result.exit_code = pclose(pipe);
  return result;
}

unsigned partsInTheBin()
{
  TakePart call;
  call.request.select = TakePart::Request::BY_ID;
  call.request.id = -1;  // no part has that
  EXPECT_TRUE(ros::service::waitForService("virtual_cell/take_part", ros::Duration(120)));
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(120);
  do  // the bin is being filled
    EXPECT_TRUE(ros::service::call("virtual_cell/take_part", call));
  while (call.response.outcome == TakePart::Response::NOT_READY && ros::WallDuration(0.2).sleep() &&
         ros::WallTime::now() < end);
  EXPECT_EQ(call.response.outcome, TakePart::Response::NO_SUCH_PART) << call.response.message;
  return call.response.num_left;
}

/// Each line of a grasp can be sent to the robot: it is a pose within its reach, above the bin.
void expectMoves(const std::string& output)
{
  int num_moves = 0;
  for (std::size_t at = output.find("movel("); at != std::string::npos; at = output.find("movel(", at + 1))
  {
    const auto pose = bin_picking::fromUrScript(output.substr(at, output.find('\n', at) - at));
    EXPECT_LT(pose.translation().norm(), 1.0) << output;
    EXPECT_LT(pose.translation().x(), 0) << "the bin is in front of base_link, behind base";
    EXPECT_GT(pose.translation().z(), 0.1) << "the floor of the bin";
    ++num_moves;
  }
  EXPECT_EQ(num_moves, std::stoi(output.substr(output.rfind('\n', output.rfind(" attempts: ")) + 1))) << output;
}

/// The program empties the bin, and its account is the truth.
void expectTrueAccount(const std::string& program)
{
  const unsigned before = partsInTheBin();
  const Run result = run(program + " _speed:=100");
  const std::size_t summary = result.output.rfind(" attempts: ");
  ASSERT_NE(summary, std::string::npos) << result.output;
  const int num_picked = std::stoi(result.output.substr(summary + std::string(" attempts: ").size()));
  EXPECT_EQ(partsInTheBin(), before - static_cast<unsigned>(num_picked)) << result.output;
  EXPECT_EQ(partsInTheBin(), 0u) << result.output;
  EXPECT_EQ(result.exit_code, 0) << result.output;
  expectMoves(result.output);
}

TEST(PickingLoop, TheProgramInCppGivesATrueAccount) { expectTrueAccount(BIN_PICKING_PROGRAM_DIR "/ur5e_picker"); }

TEST(PickingLoop, TheProgramInPythonGivesATrueAccount)
{
  std_srvs::Trigger refill;
  ASSERT_TRUE(ros::service::call("virtual_cell/refill", refill));
  ASSERT_TRUE(refill.response.success) << refill.response.message;
  expectTrueAccount(BIN_PICKING_SOURCE_DIR "/scripts/ur5e_picker.py");
}

TEST(PickingLoop, AnArmThatDoesNotMoveIsRefused)
{
  for (const char* program : {BIN_PICKING_PROGRAM_DIR "/ur5e_picker", BIN_PICKING_SOURCE_DIR "/scripts/ur5e_picker.py"})
  {
    const auto result = run(std::string(program) + " _speed:=0");
    EXPECT_NE(result.exit_code, 0);
    EXPECT_NE(result.output.find("it must be a positive number"), std::string::npos) << result.output;
  }
}

TEST(PickingLoop, ThePictureOfTheArmStandsWhereItsKinematicsSay)
{
  const bin_picking::Kinematics arm(
      bin_picking::loadRobot(std::string(BIN_PICKING_SOURCE_DIR) + "/config/robots/ur5e.yaml"));
  bin_picking::Joints joints;
  joints << 0.3, -1.1, 1.7, -2.2, -1.4, 0.8;
  sensor_msgs::JointState state;
  state.name.assign(arm.robot().joint_names.begin(), arm.robot().joint_names.end());
  state.position.assign(joints.data(), joints.data() + joints.size());

  ros::NodeHandle nh;
  ros::Publisher publisher = nh.advertise<sensor_msgs::JointState>("joint_states", 1);
  tf2_ros::Buffer buffer;
  tf2_ros::TransformListener listener(buffer);
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(30);
  bin_picking::Pose difference = bin_picking::Pose::Identity();
  double error = 1;
  while (error > 1e-6 && ros::WallTime::now() < end)
  {
    state.header.stamp = ros::Time::now();
    publisher.publish(state);
    ros::WallDuration(0.1).sleep();
    if (!buffer.canTransform("base", "tool0", ros::Time(0)))
      continue;
    const auto transform = buffer.lookupTransform("base", "tool0", ros::Time(0)).transform;
    difference = arm.forward(joints).inverse() * bin_picking_ros::fromMessage(transform);
    error = (difference.matrix() - bin_picking::Pose::Identity().matrix()).cwiseAbs().maxCoeff();
  }
  EXPECT_LT(error, 1e-6) << difference.matrix();
}
}  // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "picking_loop_test");
  ros::NodeHandle nh;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
