// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "cell_frames.hpp"

#include <utility>

namespace bin_picking_ros
{
CellFrames::CellFrames(const ros::NodeHandle& nh, Names names, std::optional<bin_picking::Bin> bin)
    : names_(std::move(names)), bin_(std::move(bin)), lookup_(nh)
{}

bin_picking::Pose CellFrames::find(const std::string& target, const std::string& source, const ros::Time& stamp) const
{
  return lookup_.lookup(target, source, stamp, names_.tf_timeout);
}

OutputFrame CellFrames::output(const std_msgs::Header& cloud, const std::string& frame) const
{
  if (cloud.frame_id.empty())
    throw RequestError(ReturnCode::BAD_CLOUD, "The cloud has no frame_id, so that nobody knows where its points are.");
  const std::string& wanted = frame.empty() ? names_.output : frame;
  OutputFrame output;
  output.header.stamp = cloud.stamp;
  output.header.frame_id = wanted.empty() ? cloud.frame_id : wanted;
  output.T_output_camera = find(output.header.frame_id, cloud.frame_id, cloud.stamp);
  return output;
}

std::optional<bin_picking::Bin> CellFrames::bin(const std_msgs::Header& cloud) const
{
  std::optional<bin_picking::Bin> bin = bin_;
  if (bin && !names_.bin.empty())
    bin->T_camera_bin = find(cloud.frame_id, names_.bin, cloud.stamp);
  return bin;
}

std::optional<bin_picking::Pose> CellFrames::robotBase(const std_msgs::Header& cloud) const
{
  if (names_.robot_base.empty())
    return std::nullopt;
  return find(names_.robot_base, cloud.frame_id, cloud.stamp);
}

bin_picking::Pose CellFrames::fixedFrame(const std::optional<bin_picking::Bin>& bin,
                                         const std::optional<bin_picking::Pose>& T_base_camera)
{
  if (bin)
    return bin->T_camera_bin.inverse();
  return T_base_camera.value_or(bin_picking::Pose::Identity());
}
}  // namespace bin_picking_ros
