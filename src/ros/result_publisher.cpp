// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "result_publisher.hpp"

#include <utility>
#include <vector>

#include "marker_primitives.hpp"
#include "pose_conversion.hpp"
#include "segmentation_image.hpp"

namespace bin_picking_ros
{
namespace msgs = bin_picking_perception;

ResultPublisher::ResultPublisher(ros::NodeHandle private_nh, std::string tf_prefix)
    : tf_prefix_(std::move(tf_prefix)),
      poses_(private_nh.advertise<geometry_msgs::PoseArray>("poses", 1, true)),
      detections_(private_nh.advertise<msgs::DetectionArray>("detections", 1, true)),
      grasps_(private_nh.advertise<msgs::GraspArray>("grasps", 1, true)),
      markers_(private_nh.advertise<visualization_msgs::MarkerArray>("markers", 1, true)),
      segmentation_(private_nh.advertise<sensor_msgs::Image>("segmentation", 1))
{}

void ResultPublisher::setMarkerMaker(std::shared_ptr<const MarkerMaker> marker_maker)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  marker_maker_ = std::move(marker_maker);
}

void ResultPublisher::publish(const PickResult& result, const OutputFrame& output)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  last_result_ = output.header.stamp;
  poses_.publish(toPoseArray(result, output));
  detections_.publish(toDetectionArray(result, output));
  grasps_.publish(toGraspArray(result, output));
  if (marker_maker_)
    markers_.publish(marker_maker_->make(result, output));
  if (result.detection.segmentation)
    segmentation_.publish(toImage(*result.detection.segmentation, result.cloud_header));
  broadcast(result, output);
}

void ResultPublisher::publishFailure(const ReturnCode& code, const std_msgs::Header& header)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!header.stamp.isZero() && header.stamp < last_result_)  // without a time, nobody knows which is newer
    return;
  geometry_msgs::PoseArray poses;
  poses.header = header;
  poses_.publish(poses);
  msgs::DetectionArray detections;
  detections.header = header;
  detections.code = code;
  detections_.publish(detections);
  msgs::GraspArray grasps;
  grasps.header = header;
  grasps_.publish(grasps);
  markers_.publish(noMarkers(header));
}

/// A cloud may be used twice, but tf keeps the first pose of a frame and time, and warns about every other one. So that
/// the latest is that of the last answer, each goes a nanosecond after the one before.
ros::Time ResultPublisher::stampFor(const std::string& frame, const ros::Time& cloud)
{
  Sent& last = last_sent_[frame];
  last.tf = last.cloud == cloud ? last.tf + ros::Duration(0, 1) : cloud;
  last.cloud = cloud;
  return last.tf;
}

void ResultPublisher::broadcast(const PickResult& result, const OutputFrame& output)
{
  std::vector<geometry_msgs::TransformStamped> transforms;
  const auto add = [&](const std::string& name, const bin_picking::Pose& T_camera_frame) {
    transforms.emplace_back();
    transforms.back().header = output.header;
    transforms.back().header.stamp = stampFor(name, output.header.stamp);
    transforms.back().child_frame_id = tf_prefix_ + name;
    transforms.back().transform = toTransformMessage(output.T_output_camera * T_camera_frame);
  };
  for (std::size_t k = 0; k < result.detection.detections.size(); ++k)
    add("part_" + std::to_string(k), result.detection.detections[k].T_camera_object);
  if (!result.selection.grasps.empty())
  {
    add("grasp", result.selection.grasps.front().tip.grasp);
    add("pre_grasp", result.selection.grasps.front().tip.pre_grasp);
  }
  if (!transforms.empty())
    broadcaster_.sendTransform(transforms);
}
}  // namespace bin_picking_ros
