// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>

#include <memory>

#include "virtual_cell_node.hpp"

namespace bin_picking_ros
{
/// Lifetime of a VirtualCellNode within a nodelet manager.
class VirtualCellNodelet : public nodelet::Nodelet
{
private:
  void onInit() override { node_ = std::make_unique<VirtualCellNode>(getNodeHandle(), getPrivateNodeHandle()); }

  std::unique_ptr<VirtualCellNode> node_;
};
}  // namespace bin_picking_ros

PLUGINLIB_EXPORT_CLASS(bin_picking_ros::VirtualCellNodelet, nodelet::Nodelet)
