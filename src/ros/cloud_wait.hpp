// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>

#include "cloud_buffer.hpp"

namespace bin_picking_ros
{
/// When a cloud is wanted, and how long it is waited for.
struct CloudWish
{
  ros::Time called;                      ///< of the request
  CloudBuffer::Clock::time_point start;  ///< the same moment
  double seconds = 0;                    ///< WAIT_NEW: how long to wait; USE_LATEST: how old the cloud may be
  std::string topic;                     ///< for messages
};

/// A cloud stamped at or after the call. \throws RequestError NO_CLOUD, NOT_READY (the buffer was closed)
sensor_msgs::PointCloud2ConstPtr waitForNew(const CloudBuffer& clouds, const CloudWish& wish);

/// The newest cloud, if it is young enough. \throws RequestError NO_CLOUD, STALE_CLOUD
sensor_msgs::PointCloud2ConstPtr takeLatest(const CloudBuffer& clouds, const CloudWish& wish);

/// "0.25 s"
std::string secondsText(double seconds);
}  // namespace bin_picking_ros
