// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <memory>
#include <vector>

#include "gripper_set.hpp"
#include "message_conversion.hpp"

namespace bin_picking_ros
{
/// Pictures of results for rviz. Namespaces: parts (coloured by rank), labels, rejected (gray), bin; grasp (arrow from
/// the pre-grasp), path (line from pre-grasp over grasp to retreat) and gripper, all of the best grasp; rejected_grasps
/// (thin red arrows) and rejected_grasp_labels (why), one per reason and a few at most; avoided (translucent balls).
class MarkerMaker
{
public:
  MarkerMaker(std::vector<std::shared_ptr<const bin_picking::TrainedModel>> models, GripperSet grippers);

  /// Begins with the removal of all earlier markers.
  visualization_msgs::MarkerArray make(const PickResult& result, const OutputFrame& output) const;

private:
  visualization_msgs::Marker partMarker(const bin_picking::Detection& detection, const OutputFrame& output) const;
  visualization_msgs::Marker labelMarker(std::size_t rank, const bin_picking::Detection& detection,
                                         const OutputFrame& output) const;
  void addDetections(const PickResult& result, const OutputFrame& output,
                     visualization_msgs::MarkerArray& markers) const;

  std::vector<std::shared_ptr<const bin_picking::TrainedModel>> models_;
  std::vector<bin_picking::TriangleMesh> meshes_;
  GripperSet grippers_;
};
}  // namespace bin_picking_ros
