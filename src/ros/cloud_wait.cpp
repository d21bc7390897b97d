// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "cloud_wait.hpp"

#include <sstream>

#include "return_code.hpp"
#include "time_difference.hpp"

namespace bin_picking_ros
{
using sensor_msgs::PointCloud2ConstPtr;

std::string secondsText(double seconds)
{
  std::ostringstream text;
  text.precision(3);
  text << seconds << " s";
  return text.str();
}

PointCloud2ConstPtr waitForNew(const CloudBuffer& clouds, const CloudWish& wish)
{
  const auto until = wish.start + std::chrono::duration_cast<CloudBuffer::Clock::duration>(
                                      std::chrono::duration<double>(wish.seconds));
  if (PointCloud2ConstPtr cloud = clouds.waitForStamp(wish.called, until))
    return cloud;
  if (clouds.closed())
    throw RequestError(ReturnCode::NOT_READY, "The node is shutting down.");
  const PointCloud2ConstPtr latest = clouds.latest();
  if (!latest)
    throw RequestError(ReturnCode::NO_CLOUD,
                       "No cloud has come on " + wish.topic + " yet; " + secondsText(wish.seconds) + " were waited.");
  throw RequestError(ReturnCode::NO_CLOUD, "No cloud exposed after the call came within " + secondsText(wish.seconds) +
                                               "; the newest is stamped " +
                                               secondsText(secondsBetween(latest->header.stamp, wish.called)) +
                                               " before the call.");
}

PointCloud2ConstPtr takeLatest(const CloudBuffer& clouds, const CloudWish& wish)
{
  PointCloud2ConstPtr cloud = clouds.latest();
  if (!cloud)
    throw RequestError(ReturnCode::NO_CLOUD, "No cloud has come on " + wish.topic + " yet.");
  if (cloud->header.stamp.isZero())
    throw RequestError(ReturnCode::STALE_CLOUD, "The newest cloud carries no time, so that its age is not known.");
  const double age = secondsBetween(cloud->header.stamp, wish.called);
  if (age > wish.seconds)
    throw RequestError(ReturnCode::STALE_CLOUD, "The newest cloud is " + secondsText(age) + " old; at most " +
                                                    secondsText(wish.seconds) + " are allowed.");
  return cloud;
}
}  // namespace bin_picking_ros
