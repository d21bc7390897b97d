// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_srvs/Trigger.h>

#include <cstddef>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace bin_picking_ros
{
/// Files named by paths, package:// URLs or patterns ("scene_*.pcd"); a pattern's files in alphabetical order.
/// \throws bin_picking::FileError if a path or pattern names no file
std::vector<std::string> expandFiles(const std::vector<std::string>& patterns);

/// Publishes PCD files on `points` as a camera would: periodically, or when ~trigger is called. Clouds are stamped when
/// they are published.
class CloudPlayer
{
public:
  /// Returns at once; files are read in the background. \throws bin_picking::Error for wrong parameters or missing
  /// files
  CloudPlayer(ros::NodeHandle nh, ros::NodeHandle private_nh);
  ~CloudPlayer();
  CloudPlayer(const CloudPlayer&) = delete;
  CloudPlayer& operator=(const CloudPlayer&) = delete;

private:
  void loadAll();
  bool trigger(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  /// False and a reason if there is nothing to publish.
  std_srvs::Trigger::Response publishNext();
  void prepareNext();

  std::vector<std::string> files_;
  std::string frame_id_;
  bool loop_ = true;

  std::mutex mutex_;
  std::vector<sensor_msgs::PointCloud2> clouds_;
  std::size_t next_index_ = 0;
  sensor_msgs::PointCloud2Ptr next_;  ///< copied beforehand: a published message must not change any more
  std::string status_ = "The files are still being read.";
  bool stop_ = false;

  ros::Publisher publisher_;
  ros::ServiceServer trigger_;
  ros::WallTimer timer_;
  std::thread loader_;
};
}  // namespace bin_picking_ros
