// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <sensor_msgs/Image.h>

#include "bin_picking_perception/detector.hpp"

namespace bin_picking_ros
{
/// The depth in gray with the segments over it, each in a colour of its own (rgb8): pale where a segment is no
/// candidate target, strong where it is one.
sensor_msgs::Image toImage(const bin_picking::SegmentationView& view, const std_msgs::Header& header);
}  // namespace bin_picking_ros
