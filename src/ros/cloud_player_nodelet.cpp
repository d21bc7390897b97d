// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>

#include <memory>

#include "cloud_player.hpp"

namespace bin_picking_ros
{
/// Lifetime of a CloudPlayer within a nodelet manager.
class CloudPlayerNodelet : public nodelet::Nodelet
{
private:
  void onInit() override
  {
    try
    {
      player_ = std::make_unique<CloudPlayer>(getNodeHandle(), getPrivateNodeHandle());
    }
    catch (const std::exception& error)
    {
      NODELET_FATAL_STREAM("The cloud player does not start. " << error.what());
      throw;  // the manager reports that loading failed
    }
  }

  std::unique_ptr<CloudPlayer> player_;
};
}  // namespace bin_picking_ros

PLUGINLIB_EXPORT_CLASS(bin_picking_ros::CloudPlayerNodelet, nodelet::Nodelet)
