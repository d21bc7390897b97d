// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <gtest/gtest.h>
#include <ros/ros.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <boost/filesystem.hpp>
#include <string>
#include <vector>

#include "detector_node.hpp"
#include "pose_conversion.hpp"
#include "virtual_camera.hpp"

namespace bin_picking_ros
{
using bin_picking::Pose;
using bin_picking_perception::GetBestGrasp;
using test_clouds::makeMessage;

constexpr double PATIENCE = 120;  // seconds; only reached when something is broken

/// T_base_camera of the static transform: the camera looks straight down from 0.9 m.
inline Pose cameraInBase()
{
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(0.5, 0, 0.9);
  return pose;
}

inline geometry_msgs::TransformStamped stamped(const std::string& parent, const std::string& child, const Pose& pose,
                                               const ros::Time& stamp)
{
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = parent;
  transform.header.stamp = stamp;
  transform.child_frame_id = child;
  transform.transform = toTransformMessage(pose);
  return transform;
}

/// One node for all tests of this file: that it lives on after each of them is what they check.
class DetectorNodeTest : public testing::Test
{
protected:
  static void SetUpTestSuite()
  {
    scene_ = new test_clouds::BlockScene(test_clouds::renderBlock());
    cache_ = (boost::filesystem::temp_directory_path() / boost::filesystem::unique_path()).string();
    ros::NodeHandle nh("cell");
    ros::NodeHandle private_nh("cell/detector");
    setParameters(private_nh);
    node_ = new DetectorNode(nh, private_nh);
    camera_ = new test_clouds::VirtualCamera(nh, "points");
    client_ = new ros::ServiceClient(private_nh.serviceClient<GetBestGrasp>("get_best_grasp"));
    broadcaster_ = new tf2_ros::StaticTransformBroadcaster;
    broadcaster_->sendTransform({stamped("base_link", "camera", cameraInBase(), ros::Time::now()),
                                 stamped("island", "palm_tree", Pose::Identity(), ros::Time::now())});
  }

  static void TearDownTestSuite()
  {
    delete broadcaster_;
    delete client_;
    delete camera_;
    delete node_;
    delete scene_;
    boost::filesystem::remove_all(cache_);
  }

  static void setParameters(const ros::NodeHandle& private_nh)
  {
    const std::string folder = std::string(BIN_PICKING_SOURCE_DIR) + "/test/ros/step_block";
    private_nh.setParam("parts", std::vector<std::string>{folder});
    private_nh.setParam("bin", folder + "/bin.yaml");
    private_nh.setParam("gripper", std::string(BIN_PICKING_SOURCE_DIR) + "/config/grippers/ag95.yaml");
    private_nh.setParam("model_cache", cache_);
    private_nh.setParam("output_frame", "base_link");
    private_nh.setParam("tf_prefix", "cell_");
    private_nh.setParam("cloud_timeout", 20);
    private_nh.setParam("deadline", 0);
    private_nh.setParam("grippers",
                        std::vector<std::string>{std::string(BIN_PICKING_SOURCE_DIR) + "/test/ros/wide_hand.yaml"});
    private_nh.setParam("remembered_answers", 4);
  }

  /// Asks until the models are there.
  static GetBestGrasp::Response ask(GetBestGrasp::Request request = GetBestGrasp::Request())
  {
    return ask(request, *client_);
  }

  static GetBestGrasp::Response ask(GetBestGrasp::Request request, ros::ServiceClient& client)
  {
    GetBestGrasp::Response response;
    EXPECT_TRUE(client.waitForExistence(ros::Duration(PATIENCE)));
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(PATIENCE);
    do
      EXPECT_TRUE(client.call(request, response)) << "the call itself failed";
    while (response.code.value == ReturnCode::NOT_READY && ros::WallTime::now() < end);
    EXPECT_FALSE(response.code.name.empty());
    EXPECT_EQ(response.grasps.empty(), response.code.value != ReturnCode::OK);
    return response;
  }

  static void expectGoodAnswer()
  {
    camera_->start(makeMessage(scene_->grid));
    const GetBestGrasp::Response response = ask();
    camera_->stop();
    ASSERT_EQ(response.code.value, ReturnCode::OK) << response.code.name << ": " << response.code.message;
    ASSERT_FALSE(response.detections.empty());
    expectTruth(fromMessage(response.detections[0].pose));
  }

  /// Within half a leaf and two degrees: the scene has no noise, its pixels are 1 mm wide.
  static void expectTruth(const Pose& T_base_block)
  {
    const Pose difference = (cameraInBase() * scene_->T_camera_block).inverse() * T_base_block;
    EXPECT_LT(difference.translation().norm(), 0.0015);
    EXPECT_LT(Eigen::AngleAxisd(difference.linear()).angle(), 2 * M_PI / 180);
  }

  static inline test_clouds::BlockScene* scene_ = nullptr;
  static inline DetectorNode* node_ = nullptr;
  static inline test_clouds::VirtualCamera* camera_ = nullptr;
  static inline ros::ServiceClient* client_ = nullptr;
  static inline tf2_ros::StaticTransformBroadcaster* broadcaster_ = nullptr;
  static inline std::string cache_;
};

/// The next message of a topic, or the latched one.
template <typename Message>
boost::shared_ptr<const Message> receive(const std::string& topic)
{
  return ros::topic::waitForMessage<Message>(topic, ros::Duration(PATIENCE));
}
}  // namespace bin_picking_ros
