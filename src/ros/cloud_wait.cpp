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

void requireCredibleStamp(const ros::Time& stamp, const ros::Time& now)
{
  if (stamp.isZero())
    throw RequestError(ReturnCode::STALE_CLOUD,
                       "The cloud carries no time, so that nobody knows how old it is and where the camera was.");
  const double lead = secondsBetween(now, stamp);
  if (lead > MAX_CLOCK_LEAD)
    throw RequestError(ReturnCode::STALE_CLOUD, "The cloud is stamped " + secondsText(lead) +
                                                    " in the future, at most " + secondsText(MAX_CLOCK_LEAD) +
                                                    " are allowed: the clock of the sensor's computer is ahead.");
}

namespace
{
/// Why no cloud was good enough, where at least one has come.
[[noreturn]] void failWithout(const sensor_msgs::PointCloud2& latest, const CloudWish& wish, bool is_new)
{
  requireCredibleStamp(latest.header.stamp, ros::Time::now());
  const std::string start = "No cloud exposed after the call came within " + secondsText(wish.seconds);
  if (!is_new)
    throw RequestError(ReturnCode::NO_CLOUD, start + "; the newest had come before the call.");
  throw RequestError(ReturnCode::NO_CLOUD, start + "; the newest is stamped " +
                                               secondsText(secondsBetween(latest.header.stamp, wish.called)) +
                                               " before the call.");
}
}  // namespace

PointCloud2ConstPtr waitForNew(const CloudBuffer& clouds, const CloudWish& wish)
{
  const auto until = wish.start + std::chrono::duration_cast<CloudBuffer::Clock::duration>(
                                      std::chrono::duration<double>(wish.seconds));
  if (PointCloud2ConstPtr cloud = clouds.waitForStamp(wish.called, wish.num_seen, until))
    return cloud;
  if (clouds.closed())
    throw RequestError(ReturnCode::NOT_READY, "The node is shutting down.");
  const PointCloud2ConstPtr latest = clouds.latest();
  if (!latest)
    throw RequestError(ReturnCode::NO_CLOUD,
                       "No cloud has come on " + wish.topic + " yet; " + secondsText(wish.seconds) + " were waited.");
  failWithout(*latest, wish, clouds.numReceived() > wish.num_seen);
}

PointCloud2ConstPtr takeLatest(const CloudBuffer& clouds, const CloudWish& wish)
{
  PointCloud2ConstPtr cloud = clouds.latest();
  if (!cloud)
    throw RequestError(ReturnCode::NO_CLOUD, "No cloud has come on " + wish.topic + " yet.");
  requireCredibleStamp(cloud->header.stamp, ros::Time::now());
  const double age = secondsBetween(cloud->header.stamp, wish.called);
  if (age > wish.seconds)
    throw RequestError(ReturnCode::STALE_CLOUD, "The newest cloud is " + secondsText(age) + " old; at most " +
                                                    secondsText(wish.seconds) + " are allowed.");
  return cloud;
}
}  // namespace bin_picking_ros
