// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <bin_picking_perception/DetectionArray.h>
#include <bin_picking_perception/GetBestGrasp.h>
#include <bin_picking_perception/GraspArray.h>
#include <geometry_msgs/PoseArray.h>

#include <string>
#include <vector>

#include "pick_pipeline.hpp"

namespace bin_picking_ros
{
/// Where results are expressed: the header that they carry, and the way there from the cloud's frame.
struct OutputFrame
{
  std_msgs::Header header;  ///< stamp of the cloud, output frame
  bin_picking::Pose T_output_camera = bin_picking::Pose::Identity();
};

/// The accepted ones, best first, then the rejected ones.
bin_picking_perception::DetectionArray toDetectionArray(const PickResult& result, const OutputFrame& output);
bin_picking_perception::GraspArray toGraspArray(const PickResult& result, const OutputFrame& output);
/// Accepted detections only, in the same order.
geometry_msgs::PoseArray toPoseArray(const PickResult& result, const OutputFrame& output);

/// How often each reason excluded a detection or a grasp, most frequent first.
std::vector<bin_picking_perception::RejectCount> countRejections(const PickResult& result);

/// "bin wall collision"
std::string inWords(bin_picking::GraspRejection rejection);

/// One line about the grasps: how many, and how often which reason excluded one.
std::string summarize(const bin_picking::GraspSelection& selection);

/// The whole answer except its age. \param list_rejected the rejected grasps too
bin_picking_perception::GetBestGrasp::Response toResponse(const PickResult& result, const OutputFrame& output,
                                                          bool list_rejected = false);
}  // namespace bin_picking_ros
