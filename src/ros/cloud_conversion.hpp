// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <sensor_msgs/PointCloud2.h>

#include <cstddef>

namespace bin_picking_ros
{
/// Reads x, y, z of any layout that the message can describe: fields in any order and at any offset, float32 or
/// float64, either byte order, padded points and rows. Width and height are kept, is_dense of the message is not
/// believed. \throws bin_picking::CloudError Empty (no points), BadLayout (x, y or z missing or not a floating-point
/// number, sizes that
///   contradict each other, fewer bytes than announced)
pcl::PointCloud<pcl::PointXYZ> toPclCloud(const sensor_msgs::PointCloud2& message);

/// What a cheap look at a cloud tells.
struct CloudSummary
{
  std::size_t sampled = 0;  ///< points looked at
  std::size_t valid = 0;    ///< of them: finite and not (0, 0, 0)
  double median_depth = 0;  ///< of the valid ones, in the unit of the cloud; NaN if there are none

  double validShare() const { return sampled > 0 ? static_cast<double>(valid) / static_cast<double>(sampled) : 0.0; }
};

/// Looks at every `stride`-th point of every `stride`-th row. \throws as toPclCloud
CloudSummary summarizeCloud(const sensor_msgs::PointCloud2& message, std::size_t stride);
}  // namespace bin_picking_ros
