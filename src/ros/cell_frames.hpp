// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <std_msgs/Header.h>

#include <optional>
#include <string>

#include "bin_picking_perception/scene/bin.hpp"
#include "frame_lookup.hpp"
#include "message_conversion.hpp"
#include "node_parameters.hpp"

namespace bin_picking_ros
{
/// Where output, bin and robot are as seen from the camera, at the moment of an exposure. Thread-safe. Transforms are
/// waited for as long as ~tf_timeout says, and no longer than `patience`, seconds.
class CellFrames
{
public:
  /// \throws bin_picking::Error the bin's file is wrong
  CellFrames(const ros::NodeHandle& nh, const NodeParameters& parameters,
             const std::optional<bin_picking::Robot>& robot);

  /// \param frame empty: that of the node \throws RequestError TF_*, BAD_TRANSFORM, BAD_CLOUD without frame
  OutputFrame output(const std_msgs::Header& cloud, const std::string& frame, double patience) const;

  /// The bin in the cloud's frame; nothing where none is configured. \throws RequestError TF_*, BAD_TRANSFORM
  std::optional<bin_picking::Bin> bin(const std_msgs::Header& cloud, double patience) const;

  /// T_base_camera, in the frame `base` of the controller; nothing without a robot. \throws RequestError TF_*,
  /// BAD_TRANSFORM
  std::optional<bin_picking::Pose> robotBase(const std_msgs::Header& cloud, double patience) const;

  /// T_fixed_camera, for what is remembered from one cloud to the next: the frame of the bin, else of the robot's base,
  /// else the camera's, which then has to stand still.
  static bin_picking::Pose fixedFrame(const std::optional<bin_picking::Bin>& bin,
                                      const std::optional<bin_picking::Pose>& T_base_camera);

  /// Ends all waiting, now and in future.
  void close() { lookup_.close(); }

private:
  bin_picking::Pose find(const std::string& target, const std::string& source, const ros::Time& stamp,
                         double patience) const;

  const std::string output_frame_;
  const std::string bin_frame_;
  const std::string robot_base_frame_;
  const std::optional<bin_picking::Robot> robot_;
  const double tf_timeout_;
  std::optional<bin_picking::Bin> bin_;
  FrameLookup lookup_;
};
}  // namespace bin_picking_ros
