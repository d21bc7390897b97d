// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <ros/node_handle.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <memory>
#include <string>
#include <vector>

#include "virtual_cell.hpp"

namespace bin_picking_ros
{
/// What the virtual cell sends: points and camera_info as a driver does, ~truth, ~truth_markers, the bin on tf. Not
/// thread-safe but for hasSubscribers.
class VirtualCellPublisher
{
public:
  VirtualCellPublisher(ros::NodeHandle nh, ros::NodeHandle private_nh);

  /// T_camera_bin as a static transform.
  void sendBinFrame(const bin_picking::Bin& bin, const std::string& camera_frame, const std::string& bin_frame);

  /// \param header frame of the camera, time of the exposure
  void publish(const bin_picking::simulation::CellScan& scan,
               const std::vector<bin_picking::simulation::CellPart>& parts, const std_msgs::Header& header);

  /// Whether anybody would receive what an exposure gives.
  bool hasSubscribers() const;

private:
  ros::Publisher points_;
  ros::Publisher camera_info_;
  ros::Publisher truth_;
  ros::Publisher truth_markers_;
  std::unique_ptr<tf2_ros::StaticTransformBroadcaster> broadcaster_;  ///< only where a frame is sent
  std::vector<bin_picking::TriangleMesh> display_meshes_;             ///< made when somebody looks for the first time
};
}  // namespace bin_picking_ros
