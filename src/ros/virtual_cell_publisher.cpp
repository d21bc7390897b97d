// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "virtual_cell_publisher.hpp"

#include "marker_primitives.hpp"
#include "pose_conversion.hpp"
#include "virtual_cell_messages.hpp"

namespace bin_picking_ros
{
VirtualCellPublisher::VirtualCellPublisher(ros::NodeHandle nh, ros::NodeHandle private_nh)
    : points_(nh.advertise<sensor_msgs::PointCloud2>("points", 1)),
      camera_info_(nh.advertise<sensor_msgs::CameraInfo>("camera_info", 1)),
      truth_(private_nh.advertise<bin_picking_perception::SceneTruth>("truth", 1, true)),
      truth_markers_(private_nh.advertise<visualization_msgs::MarkerArray>("truth_markers", 1))
{}

void VirtualCellPublisher::sendBinFrame(const bin_picking::Bin& bin, const std::string& camera_frame,
                                        const std::string& bin_frame)
{
  if (!broadcaster_)
    broadcaster_ = std::make_unique<tf2_ros::StaticTransformBroadcaster>();
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = ros::Time::now();
  transform.header.frame_id = camera_frame;
  transform.child_frame_id = bin_frame;
  transform.transform = toTransformMessage(bin.T_camera_bin);
  broadcaster_->sendTransform(transform);
}

void VirtualCellPublisher::publish(const bin_picking::simulation::CellScan& scan,
                                   const std::vector<bin_picking::simulation::CellPart>& parts,
                                   const std_msgs::Header& header)
{
  // By pointer: nodelets in the same manager get the cloud without a copy.
  truth_.publish(boost::make_shared<bin_picking_perception::SceneTruth>(toTruthMessage(scan.instances, parts, header)));
  camera_info_.publish(boost::make_shared<sensor_msgs::CameraInfo>(toCameraInfo(scan.scan.grid, header)));
  points_.publish(boost::make_shared<sensor_msgs::PointCloud2>(toCloudMessage(scan.scan.grid, header)));
  if (truth_markers_.getNumSubscribers() == 0)
    return;
  if (display_meshes_.empty())
    for (const bin_picking::simulation::CellPart& part : parts)
      display_meshes_.push_back(simplifyForDisplay(*part.mesh, MAX_DISPLAY_TRIANGLES));
  truth_markers_.publish(toTruthMarkers(scan.instances, display_meshes_, header));
}

bool VirtualCellPublisher::hasSubscribers() const
{
  return points_.getNumSubscribers() > 0 || camera_info_.getNumSubscribers() > 0 || truth_.getNumSubscribers() > 0 ||
         truth_markers_.getNumSubscribers() > 0;
}
}  // namespace bin_picking_ros
