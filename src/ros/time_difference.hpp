// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <ros/duration.h>
#include <ros/time.h>

#include <algorithm>

namespace bin_picking_ros
{
/// later - earlier, seconds. ros::Time's own difference throws beyond 68 years, which stamps of a faulty driver may be.
inline double secondsBetween(const ros::Time& earlier, const ros::Time& later)
{
  return later.toSec() - earlier.toSec();
}

/// The same for a message, cut to about 31 years either way.
inline ros::Duration durationBetween(const ros::Time& earlier, const ros::Time& later)
{
  constexpr double LONGEST = 1e9;
  return ros::Duration(std::clamp(secondsBetween(earlier, later), -LONGEST, LONGEST));
}
}  // namespace bin_picking_ros
