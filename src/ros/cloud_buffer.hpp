// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <ros/time.h>
#include <sensor_msgs/PointCloud2.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>

namespace bin_picking_ros
{
/// The newest cloud, as the shared pointer it came as. Storing is all that the subscriber's callback does, so that
/// neither a long detection nor a waiting service call holds up the driver.
class CloudBuffer
{
public:
  using Clock = std::chrono::steady_clock;

  void store(const sensor_msgs::PointCloud2ConstPtr& cloud);

  /// nullptr if none has come yet.
  sensor_msgs::PointCloud2ConstPtr latest() const;

  /// Number of clouds that have come so far.
  std::uint64_t numReceived() const;

  /// When the newest cloud came; the start of time if none has.
  Clock::time_point lastReceived() const;

  /// Waits for a cloud that is stamped at or after `earliest` and is none of the `num_seen` first: where the sensor's
  /// clock is ahead, the stamp alone would let one pass that was there before. nullptr once `until` has passed or the
  /// buffer is closed.
  sensor_msgs::PointCloud2ConstPtr waitForStamp(const ros::Time& earliest, std::uint64_t num_seen,
                                                Clock::time_point until) const;

  /// Waits for any cloud but the `num_seen` first; nullptr once the buffer is closed. \param num_seen is brought up to
  /// date
  sensor_msgs::PointCloud2ConstPtr waitForNext(std::uint64_t& num_seen) const;

  /// Ends all waiting, now and in future.
  void close();
  bool closed() const;

private:
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  sensor_msgs::PointCloud2ConstPtr latest_;
  std::uint64_t num_received_ = 0;
  Clock::time_point last_received_;
  bool closed_ = false;
};
}  // namespace bin_picking_ros
