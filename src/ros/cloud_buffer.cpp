// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "cloud_buffer.hpp"

namespace bin_picking_ros
{
void CloudBuffer::store(const sensor_msgs::PointCloud2ConstPtr& cloud)
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    latest_ = cloud;
    ++num_received_;
    last_received_ = Clock::now();
  }
  changed_.notify_all();
}

sensor_msgs::PointCloud2ConstPtr CloudBuffer::latest() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return latest_;
}

std::uint64_t CloudBuffer::numReceived() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return num_received_;
}

CloudBuffer::Clock::time_point CloudBuffer::lastReceived() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return last_received_;
}

sensor_msgs::PointCloud2ConstPtr CloudBuffer::waitForStamp(const ros::Time& earliest, std::uint64_t num_seen,
                                                           Clock::time_point until) const
{
  std::unique_lock<std::mutex> lock(mutex_);
  const auto arrived = [&] { return latest_ && num_received_ > num_seen && latest_->header.stamp >= earliest; };
  changed_.wait_until(lock, until, [&] { return closed_ || arrived(); });
  return !closed_ && arrived() ? latest_ : nullptr;
}

sensor_msgs::PointCloud2ConstPtr CloudBuffer::waitForNext(std::uint64_t& num_seen) const
{
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [&] { return closed_ || num_received_ > num_seen; });
  num_seen = num_received_;
  return closed_ ? nullptr : latest_;
}

void CloudBuffer::close()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

bool CloudBuffer::closed() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return closed_;
}
}  // namespace bin_picking_ros
