// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "frame_lookup.hpp"

#include <tf2/exceptions.h>

#include <chrono>
#include <sstream>
#include <thread>

#include "pose_conversion.hpp"
#include "return_code.hpp"

namespace bin_picking_ros
{
namespace
{
std::string describe(const std::string& target, const std::string& source, const ros::Time& stamp,
                     const std::string& why)
{
  std::ostringstream text;
  text << "No transform from " << source << " to " << target << " at the time " << stamp << ": " << why;
  return text.str();
}

bin_picking::Pose rigidPose(const geometry_msgs::TransformStamped& transform, const std::string& target,
                            const std::string& source, const ros::Time& stamp)
{
  try
  {
    return fromMessage(transform.transform);
  }
  catch (const RequestError& error)
  {
    throw RequestError(ReturnCode::BAD_TRANSFORM, describe(target, source, stamp, error.what()));
  }
}
}  // namespace

// The listener has a thread of its own: a transform must be able to come in while a callback waits for it.
FrameLookup::FrameLookup(const ros::NodeHandle& nh) : listener_(buffer_, nh, true) {}

bin_picking::Pose FrameLookup::lookup(const std::string& target, const std::string& source, const ros::Time& stamp,
                                      double timeout) const
{
  if (target == source)
    return bin_picking::Pose::Identity();
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout);
  while (true)
  {
    try
    {
      return lookupNow(target, source, stamp);
    }
    catch (const RequestError&)
    {
      if (closed_ || std::chrono::steady_clock::now() >= end)
        throw;
    }
    // tf2's own waiting follows ROS time and hangs while a simulated clock stands still.
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

bin_picking::Pose FrameLookup::lookupNow(const std::string& target, const std::string& source,
                                         const ros::Time& stamp) const
{
  try
  {
    return rigidPose(buffer_.lookupTransform(target, source, stamp), target, source, stamp);
  }
  catch (const tf2::ConnectivityException& error)
  {
    throw RequestError(ReturnCode::TF_DISCONNECTED, describe(target, source, stamp, error.what()));
  }
  catch (const tf2::ExtrapolationException& error)
  {
    throw RequestError(ReturnCode::TF_EXTRAPOLATION, describe(target, source, stamp, error.what()));
  }
  catch (const tf2::TransformException& error)  // LookupException, InvalidArgumentException
  {
    // Where both frames exist, what tf2 could not follow are parents that lead back to a frame itself.
    const bool are_known = buffer_._frameExists(target) && buffer_._frameExists(source);
    throw RequestError(are_known ? ReturnCode::BAD_TRANSFORM : ReturnCode::TF_UNKNOWN_FRAME,
                       describe(target, source, stamp, error.what()));
  }
}
}  // namespace bin_picking_ros
