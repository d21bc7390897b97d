// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>

#include <memory>

#include "detector_node.hpp"

namespace bin_picking_ros
{
/// Lifetime of a DetectorNode within a nodelet manager.
class DetectorNodelet : public nodelet::Nodelet
{
private:
  void onInit() override
  {
    try
    {
      node_ = std::make_unique<DetectorNode>(getNodeHandle(), getPrivateNodeHandle());
    }
    catch (const std::exception& error)
    {
      NODELET_FATAL_STREAM("The detector does not start. " << error.what());
      throw;  // the manager reports that loading failed
    }
  }

  std::unique_ptr<DetectorNode> node_;
};
}  // namespace bin_picking_ros

PLUGINLIB_EXPORT_CLASS(bin_picking_ros::DetectorNodelet, nodelet::Nodelet)
