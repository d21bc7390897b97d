// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "cell_frames.hpp"

#include <algorithm>

#include "resource_path.hpp"

namespace bin_picking_ros
{
namespace
{
std::optional<bin_picking::Bin> loadOptionalBin(const std::string& file)
{
  if (file.empty())
    return std::nullopt;
  return bin_picking::loadBin(resolveResource(file));
}
}  // namespace

CellFrames::CellFrames(const ros::NodeHandle& nh, const NodeParameters& parameters,
                       const std::optional<bin_picking::Robot>& robot)
    : output_frame_(parameters.output_frame),
      bin_frame_(parameters.bin_frame),
      robot_base_frame_(parameters.robot_base_frame),
      robot_(robot),
      tf_timeout_(parameters.tf_timeout),
      bin_(loadOptionalBin(parameters.bin)),
      lookup_(nh)
{}

bin_picking::Pose CellFrames::find(const std::string& target, const std::string& source, const ros::Time& stamp,
                                   double patience) const
{
  return lookup_.lookup(target, source, stamp, std::min(tf_timeout_, patience));
}

OutputFrame CellFrames::output(const std_msgs::Header& cloud, const std::string& frame, double patience) const
{
  if (cloud.frame_id.empty())
    throw RequestError(ReturnCode::BAD_CLOUD, "The cloud has no frame_id, so that nobody knows where its points are.");
  const std::string& wanted = frame.empty() ? output_frame_ : frame;
  OutputFrame output;
  output.header.stamp = cloud.stamp;
  output.header.frame_id = wanted.empty() ? cloud.frame_id : wanted;
  output.T_output_camera = find(output.header.frame_id, cloud.frame_id, cloud.stamp, patience);
  return output;
}

std::optional<bin_picking::Bin> CellFrames::bin(const std_msgs::Header& cloud, double patience) const
{
  std::optional<bin_picking::Bin> bin = bin_;
  if (bin && !bin_frame_.empty())
    bin->T_camera_bin = find(cloud.frame_id, bin_frame_, cloud.stamp, patience);
  return bin;
}

std::optional<bin_picking::Pose> CellFrames::robotBase(const std_msgs::Header& cloud, double patience) const
{
  if (!robot_)
    return std::nullopt;
  // tf has the ROS frame, kinematics and the controller use the one that is turned against it.
  return robot_->T_base_link_base.inverse() * find(robot_base_frame_, cloud.frame_id, cloud.stamp, patience);
}

bin_picking::Pose CellFrames::fixedFrame(const std::optional<bin_picking::Bin>& bin,
                                         const std::optional<bin_picking::Pose>& T_base_camera)
{
  if (bin)
    return bin->T_camera_bin.inverse();
  return T_base_camera.value_or(bin_picking::Pose::Identity());
}
}  // namespace bin_picking_ros
