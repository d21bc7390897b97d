// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "grasp_markers.hpp"

#include <set>

#include "marker_primitives.hpp"
#include "pose_conversion.hpp"

namespace bin_picking_ros
{
namespace
{
using bin_picking::Pose;
using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

/// From the pre-grasp to the grasp.
Marker arrow(const bin_picking::Grasp& grasp, const OutputFrame& output, const char* name_space, std::size_t id,
             double width)
{
  Marker marker = makeMarker(output.header, name_space, id, Marker::ARROW);
  marker.points.push_back(toPoint((output.T_output_camera * grasp.tip.pre_grasp).translation()));
  marker.points.push_back(toPoint((output.T_output_camera * grasp.tip.grasp).translation()));
  marker.scale.x = width;        // shaft
  marker.scale.y = 2.5 * width;  // head
  marker.scale.z = 4 * width;
  return marker;
}

/// As it arrives: open, where the flange is when it holds.
void addGripper(const bin_picking::Grasp& grasp, const bin_picking::Gripper& gripper, const OutputFrame& output,
                MarkerArray& markers)
{
  for (std::size_t i = 0; i < gripper.bodies.size(); ++i)
  {
    Marker marker = makeMarker(output.header, "gripper", i, Marker::TRIANGLE_LIST);
    marker.pose = toPoseMessage(output.T_output_camera * grasp.tool0.grasp);
    addTriangles(bin_picking::toMesh(gripper.bodyAt(i, grasp.opening)), marker);
    marker.color = toColor({0.2f, 0.7f, 0.9f}, 0.5f);
    markers.markers.push_back(marker);
  }
}
}  // namespace

void addGrasp(const bin_picking::Grasp& grasp, const bin_picking::Gripper& gripper, const OutputFrame& output,
              MarkerArray& markers)
{
  markers.markers.push_back(arrow(grasp, output, "grasp", 0, 0.004));
  markers.markers.back().color = toColor({0.1f, 0.9f, 0.9f}, 1.0f);

  Marker path = makeMarker(output.header, "path", 0, Marker::LINE_STRIP);
  for (const Pose* pose : {&grasp.tip.pre_grasp, &grasp.tip.grasp, &grasp.tip.retreat})
    path.points.push_back(toPoint((output.T_output_camera * *pose).translation()));
  path.scale.x = 0.0015;
  path.color = toColor({0.9f, 0.9f, 0.2f}, 1.0f);
  markers.markers.push_back(path);
  addGripper(grasp, gripper, output, markers);
}

void addRejectedGrasps(const std::vector<bin_picking::Grasp>& rejected, const OutputFrame& output, MarkerArray& markers)
{
  std::set<bin_picking::GraspRejection> shown;
  for (const bin_picking::Grasp& grasp : rejected)
  {
    if (shown.size() >= MAX_REJECTED_GRASPS || !shown.insert(grasp.rejection).second)
      continue;
    markers.markers.push_back(arrow(grasp, output, "rejected_grasps", shown.size() - 1, 0.002));
    markers.markers.back().color = toColor({0.9f, 0.1f, 0.1f}, 0.7f);
    Marker label = makeMarker(output.header, "rejected_grasp_labels", shown.size() - 1, Marker::TEXT_VIEW_FACING);
    label.pose = toPoseMessage(output.T_output_camera * grasp.tip.pre_grasp);
    label.scale.z = 0.010;
    label.color = toColor({1.0f, 0.5f, 0.5f}, 1.0f);
    label.text = inWords(grasp.rejection);
    markers.markers.push_back(label);
  }
}

void addAvoided(const std::vector<bin_picking::AvoidedPlace>& places, const OutputFrame& output, MarkerArray& markers)
{
  for (std::size_t i = 0; i < places.size(); ++i)
  {
    Pose T_camera_place = Pose::Identity();
    T_camera_place.translation() = places[i].center;
    Marker ball = makeMarker(output.header, "avoided", i, Marker::SPHERE);
    ball.pose = toPoseMessage(output.T_output_camera * T_camera_place);
    ball.scale.x = ball.scale.y = ball.scale.z = 2 * places[i].radius;
    ball.color = toColor({0.8f, 0.2f, 0.8f}, 0.35f);
    markers.markers.push_back(ball);
  }
}
}  // namespace bin_picking_ros
