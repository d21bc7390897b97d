// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// A picking program in its shortest form: ask for the best grasp and act on the code.
#include <bin_picking_perception/GetBestGrasp.h>
#include <ros/ros.h>

#include <cstdio>

using bin_picking_perception::GetBestGrasp;
using bin_picking_perception::ReturnCode;

namespace
{
void print(const char* name, const geometry_msgs::Pose& pose)
{
  std::printf("  %-9s position [%.4f, %.4f, %.4f] orientation [%.4f, %.4f, %.4f, %.4f]\n", name, pose.position.x,
              pose.position.y, pose.position.z, pose.orientation.x, pose.orientation.y, pose.orientation.z,
              pose.orientation.w);
}
}  // namespace

int main(int argc, char** argv)
{
  ros::init(argc, argv, "pick_client", ros::init_options::AnonymousName);
  ros::NodeHandle nh;
  ros::ServiceClient client = nh.serviceClient<GetBestGrasp>("detector/get_best_grasp");
  if (!client.waitForExistence(ros::Duration(30)))
  {
    std::printf("The service %s did not appear within 30 s.\n", client.getService().c_str());
    return 1;
  }

  GetBestGrasp call;
  call.request.acquisition = GetBestGrasp::Request::WAIT_NEW;
  do  // training a part for the first time takes a while
  {
    if (!client.call(call))
    {
      std::printf("The service %s is gone; look whether the detector still runs.\n", client.getService().c_str());
      return 1;
    }
  } while (call.response.code.value == ReturnCode::NOT_READY && ros::WallDuration(1.0).sleep() && ros::ok());

  const ReturnCode& code = call.response.code;
  std::printf("%s: %s %s\n", code.name.c_str(), code.message.c_str(), code.hint.c_str());
  if (code.value < 0)
    return 1;  // a person has to look at it
  if (call.response.grasps.empty())
    return 0;  // nothing to pick: the bin's business

  const bin_picking_perception::Grasp& best = call.response.grasps.front();
  std::printf("Best of %zu grasps: %s of %s, quality %.2f, in %s\n", call.response.grasps.size(), best.grasp_id.c_str(),
              best.part.c_str(), best.quality, best.header.frame_id.c_str());
  print("pre-grasp", best.pre_grasp);
  print("grasp", best.grasp);
  print("retreat", best.retreat);
  std::printf("  open to %.1f mm, close to %.1f mm\n", best.opening * 1000, best.width * 1000);
  return 0;
}
