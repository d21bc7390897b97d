// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// Frames: that answers are the same in any of them, and what becomes of those that are no good.
#include <functional>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/robot/kinematics.hpp"
#include "detector_node_fixture.hpp"

namespace
{
using namespace bin_picking_ros;

Pose halfTurn()
{
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return pose;
}

/// Two metres to the side: beyond any reach.
Pose farAway()
{
  Pose pose = Pose::Identity();
  pose.translation().y() = 2;
  return pose;
}

/// A frame whose quaternion has another length than 1.
geometry_msgs::TransformStamped stretched(const std::string& child, double length)
{
  auto transform = stamped("camera", child, Pose::Identity(), ros::Time::now());
  transform.transform.rotation.w = length;
  return transform;
}

class FramesTest : public DetectorNodeTest
{
protected:
  static void SetUpTestSuite()
  {
    DetectorNodeTest::SetUpTestSuite();
    broadcaster_->sendTransform({stamped("base_link", "base", halfTurn(), ros::Time::now()),
                                 stretched("stretched", 1.003), stretched("torn", 1.2),
                                 stamped("ring_a", "ring_b", Pose::Identity(), ros::Time::now()),
                                 stamped("far_away", "base_link", farAway(), ros::Time::now()),
                                 stamped("ring_b", "ring_a", Pose::Identity(), ros::Time::now())});
    camera_->start(makeMessage(scene_->grid));
    EXPECT_EQ(askIn("base").code.value, ReturnCode::OK);  // the models are loaded, and the node has heard the frames
    camera_->stop();
  }

  /// Of the newest cloud, until the node's listener knows the frame if it ever can.
  static GetBestGrasp::Response askIn(const std::string& frame)
  {
    GetBestGrasp::Request request;
    request.acquisition = GetBestGrasp::Request::USE_LATEST;
    request.max_age = ros::Duration(PATIENCE);
    request.output_frame = frame;
    GetBestGrasp::Response response;
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(20);
    do
      response = ask(request);
    while ((response.code.value == ReturnCode::NO_CLOUD || response.code.value == ReturnCode::TF_UNKNOWN_FRAME) &&
           frame != "torn" && ros::WallTime::now() < end);
    return response;
  }

  /// The code of a node with other parameters.
  static ReturnCode codeOf(const std::string& name, const std::function<void(const ros::NodeHandle&)>& set)
  {
    ros::NodeHandle nh(name);
    ros::NodeHandle private_nh(name + "/detector");
    setParameters(private_nh);
    set(private_nh);
    DetectorNode node(nh, private_nh);
    test_clouds::VirtualCamera camera(nh, "points");
    camera.start(makeMessage(scene_->grid));
    ros::ServiceClient client = private_nh.serviceClient<GetBestGrasp>("get_best_grasp");
    return ask({}, client).code;
  }
};

TEST_F(FramesTest, BaseAndBaseLinkDifferByHalfATurnAndNothingElse)
{
  const auto in_base_link = askIn("base_link");
  const auto in_base = askIn("base");
  ASSERT_EQ(in_base_link.code.value, ReturnCode::OK) << in_base_link.code.message;
  ASSERT_EQ(in_base.code.value, ReturnCode::OK) << in_base.code.message;
  ASSERT_EQ(in_base.header.stamp, in_base_link.header.stamp) << "it is one cloud";
  ASSERT_EQ(in_base.grasps.size(), in_base_link.grasps.size());
  EXPECT_EQ(in_base.grasps[0].header.frame_id, "base");
  const auto expect = [](const geometry_msgs::Pose& base, const geometry_msgs::Pose& base_link) {
    EXPECT_TRUE((halfTurn() * fromMessage(base)).isApprox(fromMessage(base_link), 1e-9));
  };
  for (std::size_t i = 0; i < in_base.grasps.size(); ++i)
  {
    const auto& a = in_base.grasps[i];
    const auto& b = in_base_link.grasps[i];
    expect(a.pre_grasp, b.pre_grasp);
    expect(a.grasp, b.grasp);
    expect(a.retreat, b.retreat);
    expect(a.pre_grasp_tool0, b.pre_grasp_tool0);
    expect(a.grasp_tool0, b.grasp_tool0);
    expect(a.retreat_tool0, b.retreat_tool0);
    EXPECT_EQ(a.quality, b.quality);
    EXPECT_TRUE(fromMessage(a.object_in_tip).isApprox(fromMessage(b.object_in_tip), 1e-12)) << "the hand has no frame";
    EXPECT_GT((fromMessage(a.grasp).translation() - fromMessage(b.grasp).translation()).norm(), 0.5)
        << "who takes one for the other sends the arm to the other side";
  }
  for (std::size_t i = 0; i < in_base.detections.size(); ++i)
    expect(in_base.detections[i].pose, in_base_link.detections[i].pose);
}

TEST_F(FramesTest, QuaternionsThatAreNoRotation)
{
  // tf2 itself lets lengths pass that differ from 1 by less than half a percent: 3 mm in a metre.
  const auto slight = askIn("stretched");
  EXPECT_EQ(slight.code.value, ReturnCode::BAD_TRANSFORM) << slight.code.message;
  EXPECT_NE(slight.code.message.find("1.003"), std::string::npos) << slight.code.message;
  EXPECT_NE(slight.code.message.find("stretched"), std::string::npos) << slight.code.message;
  EXPECT_TRUE(slight.grasps.empty());
  // Beyond that it does not take the frame at all.
  EXPECT_EQ(askIn("torn").code.value, ReturnCode::TF_UNKNOWN_FRAME);
  EXPECT_EQ(askIn("base_link").code.value, ReturnCode::OK) << "the next one is served as ever";
}

TEST_F(FramesTest, FramesInALoop)
{
  const auto response = askIn("ring_a");
  EXPECT_EQ(response.code.value, ReturnCode::BAD_TRANSFORM) << response.code.message;
  EXPECT_NE(response.code.message.find("loop"), std::string::npos) << response.code.message;
  EXPECT_EQ(askIn("base_link").code.value, ReturnCode::OK);
}

TEST_F(FramesTest, RobotWhoseBaseIsNotKnown)
{
  const std::string robot = std::string(BIN_PICKING_SOURCE_DIR) + "/config/robots/ur5e.yaml";
  const ReturnCode missing = codeOf("no_base", [&](const auto& nh) {
    nh.setParam("robot", robot);
    nh.setParam("robot_base_frame", "lost_base");
  });
  EXPECT_EQ(missing.value, ReturnCode::TF_UNKNOWN_FRAME) << missing.message;
  EXPECT_NE(missing.message.find("lost_base"), std::string::npos) << missing.message;
  const ReturnCode far = codeOf("far_base", [&](const auto& nh) {
    nh.setParam("robot", robot);
    nh.setParam("robot_base_frame", "island");
  });
  EXPECT_EQ(far.value, ReturnCode::TF_DISCONNECTED) << far.message;
}

TEST_F(FramesTest, ReachIsThatOfTheArmAtItsBase)
{
  const std::string robot = std::string(BIN_PICKING_SOURCE_DIR) + "/config/robots/ur5e.yaml";
  ros::NodeHandle nh("arm");
  ros::NodeHandle private_nh("arm/detector");
  setParameters(private_nh);
  private_nh.setParam("robot", robot);
  DetectorNode node(nh, private_nh);
  test_clouds::VirtualCamera camera(nh, "points");
  camera.start(makeMessage(scene_->grid));
  ros::ServiceClient client = private_nh.serviceClient<GetBestGrasp>("get_best_grasp");
  const auto answer = ask({}, client);
  ASSERT_EQ(answer.code.value, ReturnCode::OK) << answer.code.message << answer.summary;
  const bin_picking::Kinematics arm(bin_picking::loadRobot(robot));
  for (const auto& grasp : answer.grasps)
  {
    ASSERT_TRUE(grasp.reach_checked);
    const auto expect = [&arm](const std::vector<double>& joints, const geometry_msgs::Pose& T_base_link_tool0) {
      ASSERT_EQ(joints.size(), 6u);
      // The answer is in base_link, the arm's kinematics are in the frame of its controller.
      const Pose T_base_tool0 = halfTurn().inverse() * fromMessage(T_base_link_tool0);
      EXPECT_TRUE(arm.forward(Eigen::Map<const bin_picking::Joints>(joints.data())).isApprox(T_base_tool0, 1e-6));
    };
    expect(grasp.joints_pre_grasp, grasp.pre_grasp_tool0);
    expect(grasp.joints_grasp, grasp.grasp_tool0);
    expect(grasp.joints_retreat, grasp.retreat_tool0);
  }
  GetBestGrasp::Request request;
  request.skip_reach = true;
  const auto unchecked = ask(request, client);
  ASSERT_FALSE(unchecked.grasps.empty());
  EXPECT_FALSE(unchecked.grasps[0].reach_checked);
  EXPECT_TRUE(unchecked.grasps[0].joints_grasp.empty());
}

TEST_F(FramesTest, WhatTheArmDoesNotReachIsNotOffered)
{
  const ReturnCode code = codeOf("distant", [&](const auto& nh) {
    nh.setParam("robot", std::string(BIN_PICKING_SOURCE_DIR) + "/config/robots/ur5e.yaml");
    nh.setParam("robot_base_frame", "far_away");
  });
  EXPECT_EQ(code.value, ReturnCode::NO_PICKABLE) << code.message;
}

TEST_F(FramesTest, WrongRobotIsRefusedAtTheStart)
{
  ros::NodeHandle nh("wrong");
  ros::NodeHandle private_nh("wrong/detector");
  setParameters(private_nh);
  for (const char* file : {"/no/such/robot.yaml", BIN_PICKING_SOURCE_DIR "/config/grippers/ag95.yaml"})
  {
    private_nh.setParam("robot", file);
    EXPECT_THROW(DetectorNode(nh, private_nh), bin_picking::FileError) << file;
  }
}

TEST_F(FramesTest, BinFrameThatIsMissingOrNoRotation)
{
  const ReturnCode missing = codeOf("no_bin", [](const auto& nh) { nh.setParam("bin_frame", "lost_bin"); });
  EXPECT_EQ(missing.value, ReturnCode::TF_UNKNOWN_FRAME) << missing.message;
  EXPECT_NE(missing.message.find("lost_bin"), std::string::npos) << missing.message;
  const ReturnCode bad = codeOf("bad_bin", [](const auto& nh) { nh.setParam("bin_frame", "stretched"); });
  EXPECT_EQ(bad.value, ReturnCode::BAD_TRANSFORM) << bad.message;
}
}  // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "bad_frames_test");
  ros::NodeHandle nh;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
