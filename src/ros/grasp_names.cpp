// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "grasp_names.hpp"

#include <ros/time.h>

namespace bin_picking_ros
{
std::string runName()
{
  const char* const digits = "0123456789abcdefghijklmnopqrstuvwxyz";
  std::uint64_t number = ros::WallTime::now().toNSec() / 1000000;
  std::string name(4, '0');
  for (char& c : name)
  {
    c = digits[number % 36];
    number /= 36;
  }
  return name;
}

std::vector<PickMemory::GivenGrasp> nameGrasps(PickResult& result, const std::string& answer,
                                               const bin_picking::Pose& T_fixed_camera)
{
  std::vector<PickMemory::GivenGrasp> given;
  for (bin_picking::Grasp& grasp : result.selection.grasps)
  {
    grasp.uid = answer + "-" + std::to_string(given.size());
    given.push_back({grasp.uid, grasp.part, grasp.grasp_id, T_fixed_camera * result.centers.at(grasp.detection_index)});
  }
  return given;
}

AvoidQuery avoidQuery(PickMemory& memory, const bin_picking::Pose& T_fixed_camera)
{
  return [&memory, T_fixed_camera](std::vector<Eigen::Vector3d> centers) {
    for (Eigen::Vector3d& center : centers)
      center = T_fixed_camera * center;
    return memory.avoided(centers, ros::Time::now().toSec());
  };
}

std::vector<bin_picking::AvoidedPlace> placesInCamera(PickMemory& memory, const bin_picking::Pose& T_fixed_camera)
{
  std::vector<bin_picking::AvoidedPlace> places = memory.places(ros::Time::now().toSec());
  const bin_picking::Pose T_camera_fixed = T_fixed_camera.inverse();
  for (bin_picking::AvoidedPlace& place : places)
    place.center = T_camera_fixed * place.center;
  return places;
}
}  // namespace bin_picking_ros
