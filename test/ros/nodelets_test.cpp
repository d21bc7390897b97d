// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// The nodelets as plugins of one manager: a scene from a file, played on request, answered by the detector. Then the
// clients.
#include <bin_picking_perception/GetBestGrasp.h>
#include <gtest/gtest.h>
#include <nodelet/loader.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <boost/filesystem.hpp>
#include <cstdlib>

#include "bin_picking_perception/scene/cloud_input.hpp"
#include "virtual_camera.hpp"

namespace
{
using bin_picking_perception::GetBestGrasp;
using bin_picking_perception::ReturnCode;

const ros::Duration PATIENCE(120);  // only reached when something is broken

class TemporaryFolder
{
public:
  TemporaryFolder() : path_(boost::filesystem::temp_directory_path() / boost::filesystem::unique_path())
  {
    boost::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() { boost::filesystem::remove_all(path_); }
  std::string file(const std::string& name) const { return (path_ / name).string(); }

private:
  boost::filesystem::path path_;
};

TEST(Nodelets, PlayedSceneIsAnswered)
{
  const TemporaryFolder folder;
  bin_picking::saveGrid(test_clouds::renderBlock().grid, folder.file("scene_1.pcd"));
  ros::param::set("/cell/cloud_player/files", folder.file("scene_*.pcd"));
  ros::param::set("/cell/cloud_player/rate", 0);
  ros::param::set("/cell/cloud_player/loop", false);
  ros::param::set("/cell/detector/parts", "package://bin_picking_perception/test/ros/step_block");
  ros::param::set("/cell/detector/bin", "package://bin_picking_perception/test/ros/step_block/bin.yaml");
  ros::param::set("/cell/detector/model_cache", folder.file("models"));

  nodelet::Loader loader;
  const nodelet::M_string no_remappings;
  ASSERT_TRUE(loader.load("/cell/cloud_player", "bin_picking_perception/cloud_player", no_remappings, {}));
  ASSERT_TRUE(loader.load("/cell/detector", "bin_picking_perception/detector", no_remappings, {}));
  ASSERT_TRUE(ros::service::waitForService("/cell/detector/get_best_grasp", PATIENCE));

  GetBestGrasp call;
  call.request.acquisition = GetBestGrasp::Request::USE_LATEST;
  call.request.max_age = PATIENCE;
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(PATIENCE.toSec());
  do
    ASSERT_TRUE(ros::service::call("/cell/detector/get_best_grasp", call));
  while (call.response.code.value == ReturnCode::NOT_READY && ros::WallTime::now() < end);
  EXPECT_EQ(call.response.code.value, ReturnCode::NO_CLOUD);  // nobody has triggered the player

  std_srvs::Trigger trigger;
  do
    ASSERT_TRUE(ros::service::call("/cell/cloud_player/trigger", trigger));
  while (!trigger.response.success && ros::WallTime::now() < end);
  EXPECT_NE(trigger.response.message.find("scene_1.pcd"), std::string::npos) << trigger.response.message;
  do
    ASSERT_TRUE(ros::service::call("/cell/detector/get_best_grasp", call));
  while (call.response.code.value == ReturnCode::NO_CLOUD && ros::WallTime::now() < end);
  ASSERT_EQ(call.response.code.value, ReturnCode::OK) << call.response.code.message;
  EXPECT_EQ(call.response.header.frame_id, "camera");  // no output frame was asked for
  EXPECT_EQ(call.response.grasps.at(0).grasp_id, "tower");

  ASSERT_TRUE(ros::service::call("/cell/cloud_player/trigger", trigger));
  EXPECT_FALSE(trigger.response.success);  // the only cloud has been played, and loop is false
  EXPECT_TRUE(loader.unload("/cell/detector"));
  EXPECT_TRUE(loader.unload("/cell/cloud_player"));
}

TEST(Nodelets, WrongParametersDoNotLoad)
{
  nodelet::Loader loader;
  ros::param::set("/wrong/cloud_player/files", "/no/such/file_*.pcd");
  EXPECT_FALSE(loader.load("/wrong/cloud_player", "bin_picking_perception/cloud_player", {}, {}));
  ros::param::set("/wrong/detector/parts", "/no/such/part");
  EXPECT_FALSE(loader.load("/wrong/detector", "bin_picking_perception/detector", {}, {}));
}

TEST(LaunchFile, ItsNodeAnswersAndTheClientsUnderstandIt)
{
  ros::NodeHandle nh;
  test_clouds::VirtualCamera camera(nh, "camera/points");
  camera.start(test_clouds::makeMessage(test_clouds::renderBlock().grid));
  ASSERT_TRUE(ros::service::waitForService("detector/get_best_grasp", PATIENCE));
  for (const char* client : {BIN_PICKING_PROGRAM_DIR "/pick_client", BIN_PICKING_SOURCE_DIR "/scripts/pick_client.py"})
    EXPECT_EQ(std::system(client), 0) << client;
}
}  // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "nodelets_test");
  ros::NodeHandle nh;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
