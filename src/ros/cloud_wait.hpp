// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <string>

#include "cloud_buffer.hpp"

namespace bin_picking_ros
{
/// When a cloud is wanted, and how long it is waited for.
struct CloudWish
{
  ros::Time called;                      ///< of the request
  CloudBuffer::Clock::time_point start;  ///< the same moment
  std::uint64_t num_seen = 0;            ///< clouds that had come by then
  double seconds = 0;                    ///< WAIT_NEW: how long to wait; USE_LATEST: how old the cloud may be
  std::string topic;                     ///< for messages
};

/// Seconds by which a cloud may be stamped later than now: clocks that are synchronised (NTP, PTP) agree better.
constexpr double MAX_CLOCK_LEAD = 0.5;

/// The one place where the stamp of a cloud is judged, whoever wants to use it: transforms and the order of things hang
/// on it. \throws RequestError STALE_CLOUD: no time, or one that lies in the future
void requireCredibleStamp(const ros::Time& stamp, const ros::Time& now);

/// A cloud stamped at or after the call and received after it. Its stamp may lie in the future.
/// \throws RequestError NO_CLOUD, STALE_CLOUD (what comes has no credible stamp), NOT_READY (the buffer was closed)
sensor_msgs::PointCloud2ConstPtr waitForNew(const CloudBuffer& clouds, const CloudWish& wish);

/// The newest cloud, if it is young enough and its stamp credible. \throws RequestError NO_CLOUD, STALE_CLOUD
sensor_msgs::PointCloud2ConstPtr takeLatest(const CloudBuffer& clouds, const CloudWish& wish);

/// "0.25 s"
std::string secondsText(double seconds);
}  // namespace bin_picking_ros
