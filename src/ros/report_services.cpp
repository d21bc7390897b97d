// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "report_services.hpp"

#include <ros/console.h>

#include <string>

#include "return_code.hpp"

namespace bin_picking_ros
{
ReportServices::ReportServices(const ros::NodeHandle& private_nh, PickMemory& memory)
    : memory_(memory), spinner_(1, &queue_)
{
  ros::NodeHandle nh(private_nh);
  nh.setCallbackQueue(&queue_);
  report_ = nh.advertiseService("report_pick", &ReportServices::handleReport, this);
  clear_ = nh.advertiseService("clear_avoid_list", &ReportServices::handleClear, this);
  spinner_.start();
}

ReportServices::~ReportServices()
{
  report_.shutdown();
  clear_.shutdown();
  spinner_.stop();
}

bool ReportServices::handleReport(ReportPick::Request& request, ReportPick::Response& response)
{
  const double now = ros::Time::now().toSec();
  try
  {
    const PickMemory::GivenGrasp grasp = memory_.report(request, now);
    response.num_avoided = static_cast<std::uint32_t>(memory_.places(now).size());
    response.code =
        makeReturnCode(ReturnCode::OK, "Noted for " + grasp.grasp_id + " of " + grasp.part + "; " +
                                           std::to_string(response.num_avoided) +
                                           (response.num_avoided == 1 ? " place is avoided." : " places are avoided."));
    ROS_INFO_STREAM("Grasp " << grasp.uid << " (" << grasp.grasp_id << " of " << grasp.part << ") was reported as "
                             << static_cast<int>(request.outcome) << (request.note.empty() ? "" : ": ")
                             << request.note);
  }
  catch (...)
  {
    response.code = translateException(std::current_exception());
    response.num_avoided = static_cast<std::uint32_t>(memory_.places(now).size());
    ROS_WARN_STREAM(response.code.name << ": " << response.code.message);
  }
  return true;  // false would reach the caller without any data
}

bool ReportServices::handleClear(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response)
{
  const std::size_t num_places = memory_.clear(ros::Time::now().toSec());
  response.success = true;
  response.message = std::to_string(num_places) + (num_places == 1 ? " place was" : " places were") + " forgotten.";
  return true;
}
}  // namespace bin_picking_ros
