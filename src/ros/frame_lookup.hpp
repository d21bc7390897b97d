// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <ros/node_handle.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <atomic>
#include <string>

#include "bin_picking_perception/common/oriented_points.hpp"

namespace bin_picking_ros
{
/// Transforms between frames at the moment of exposure, with distinct failures.
class FrameLookup
{
public:
  explicit FrameLookup(const ros::NodeHandle& nh);

  /// T_target_source at `stamp`. Waits up to `timeout` seconds of wall time for the transform to come; equal frames
  /// need none. \throws RequestError TF_UNKNOWN_FRAME, TF_EXTRAPOLATION, TF_DISCONNECTED; BAD_TRANSFORM: a
  /// quaternion that is not of length 1 (0.001), numbers that are not finite, frames in a loop
  bin_picking::Pose lookup(const std::string& target, const std::string& source, const ros::Time& stamp,
                           double timeout) const;

  /// Ends all waiting, now and in future.
  void close() { closed_ = true; }

private:
  bin_picking::Pose lookupNow(const std::string& target, const std::string& source, const ros::Time& stamp) const;

  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  std::atomic<bool> closed_{false};
};
}  // namespace bin_picking_ros
