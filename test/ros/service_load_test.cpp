// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// A short run of scripts/service_load.py against a detector in a process of its own.
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <cstdlib>

#include "virtual_camera.hpp"

namespace
{
TEST(ServiceLoad, TwoClientsAtOnceWhileCloudsArrive)
{
  ros::NodeHandle nh;
  test_clouds::VirtualCamera camera(nh, "points");
  camera.start(test_clouds::makeMessage(test_clouds::renderBlock().grid));
  EXPECT_EQ(std::system(BIN_PICKING_SOURCE_DIR "/scripts/service_load.py --calls 120 --clients 2"), 0);
}

// More than the node has threads for: the others stand in its queue and are served too.
TEST(ServiceLoad, MoreClientsThanThreads)
{
  ros::NodeHandle nh;
  test_clouds::VirtualCamera camera(nh, "points");
  camera.start(test_clouds::makeMessage(test_clouds::renderBlock().grid));
  EXPECT_EQ(std::system(BIN_PICKING_SOURCE_DIR "/scripts/service_load.py --calls 60 --clients 8"), 0);
}
}  // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "service_load_test");
  ros::NodeHandle nh;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
