// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <ros/node_handle.h>
#include <tf2_ros/transform_broadcaster.h>

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "markers.hpp"

namespace bin_picking_ros
{
/// Publishes results: ~poses, ~detections, ~grasps, ~markers (latched), ~segmentation (to subscribers), and tf frames.
/// Thread-safe.
class ResultPublisher
{
public:
  ResultPublisher(ros::NodeHandle private_nh, std::string tf_prefix);

  /// What the markers are made of; without it no markers are published.
  void setMarkerMaker(std::shared_ptr<const MarkerMaker> marker_maker);

  /// Whether somebody looks at ~segmentation.
  bool wantsSegmentation() const { return segmentation_.getNumSubscribers() > 0; }

  void publish(const PickResult& result, const OutputFrame& output);

  /// Replaces the latched results by empty ones with the code: an old pose must not look like an answer. Nothing
  /// happens where they are of a newer cloud.
  void publishFailure(const ReturnCode& code, const std_msgs::Header& header);

private:
  struct Sent
  {
    ros::Time cloud;  ///< stamp of the result
    ros::Time tf;     ///< that it was sent with
  };

  ros::Time stampFor(const std::string& frame, const ros::Time& cloud);
  void broadcast(const PickResult& result, const OutputFrame& output);

  std::string tf_prefix_;
  ros::Publisher poses_;
  ros::Publisher detections_;
  ros::Publisher grasps_;
  ros::Publisher markers_;
  ros::Publisher segmentation_;
  tf2_ros::TransformBroadcaster broadcaster_;
  ros::Time last_result_;                  ///< stamp of the newest result
  std::map<std::string, Sent> last_sent_;  ///< per tf frame
  std::shared_ptr<const MarkerMaker> marker_maker_;
  std::mutex mutex_;
};
}  // namespace bin_picking_ros
