// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <bin_picking_perception/ReportPick.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <std_srvs/Trigger.h>

#include "pick_memory.hpp"

namespace bin_picking_ros
{
/// The services ~report_pick and ~clear_avoid_list, with a thread of their own: a report does not wait for a detection.
class ReportServices
{
public:
  /// \param memory must outlive this
  ReportServices(const ros::NodeHandle& private_nh, PickMemory& memory);
  ~ReportServices();
  ReportServices(const ReportServices&) = delete;
  ReportServices& operator=(const ReportServices&) = delete;

private:
  using ReportPick = bin_picking_perception::ReportPick;

  bool handleReport(ReportPick::Request& request, ReportPick::Response& response);
  bool handleClear(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);

  PickMemory& memory_;
  ros::CallbackQueue queue_;
  ros::ServiceServer report_;
  ros::ServiceServer clear_;
  ros::AsyncSpinner spinner_;
};
}  // namespace bin_picking_ros
