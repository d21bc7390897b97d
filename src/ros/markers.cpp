// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "markers.hpp"

#include <array>
#include <cstdint>
#include <cstdio>
#include <utility>

#include "bin_picking_perception/evaluation/detection_picture.hpp"
#include "grasp_markers.hpp"
#include "marker_primitives.hpp"
#include "pose_conversion.hpp"

namespace bin_picking_ros
{
namespace
{
using bin_picking::Pose;
using bin_picking::TriangleMesh;
using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

/// The twelve edges of the bin's inner box.
Marker binMarker(const bin_picking::Bin& bin, const OutputFrame& output)
{
  Marker marker = makeMarker(output.header, "bin", 0, Marker::LINE_LIST);
  marker.pose = toPoseMessage(output.T_output_camera * bin.T_camera_bin);
  marker.scale.x = 0.003;
  marker.color = toColor({0.9f, 0.9f, 0.9f}, 1.0f);
  const auto corner = [&bin](unsigned bits) {
    return toPoint({((bits & 1u) ? 0.5 : -0.5) * bin.inner_size.x(), ((bits & 2u) ? 0.5 : -0.5) * bin.inner_size.y(),
                    (bits & 4u) ? bin.inner_size.z() : 0.0});
  };
  for (unsigned from = 0; from < 8; ++from)
    for (const unsigned direction : {1u, 2u, 4u})
      if ((from & direction) == 0)
      {
        marker.points.push_back(corner(from));
        marker.points.push_back(corner(from | direction));
      }
  return marker;
}
}  // namespace

MarkerMaker::MarkerMaker(std::vector<std::shared_ptr<const bin_picking::TrainedModel>> models, GripperSet grippers)
    : models_(std::move(models)), grippers_(std::move(grippers))
{
  for (const auto& model : models_)
    meshes_.push_back(simplifyForDisplay(model->mesh, MAX_DISPLAY_TRIANGLES));
}

Marker MarkerMaker::partMarker(const bin_picking::Detection& detection, const OutputFrame& output) const
{
  const TriangleMesh& mesh = meshes_.at(detection.model_index);
  Marker marker = makeMarker(output.header, "parts", 0, mesh.empty() ? Marker::POINTS : Marker::TRIANGLE_LIST);
  marker.pose = toPoseMessage(output.T_output_camera * detection.T_camera_object);
  addTriangles(mesh, marker);
  if (mesh.empty())  // a model from points only
  {
    marker.scale.x = marker.scale.y = 0.001;
    for (const Eigen::Vector3f& point : models_[detection.model_index]->points.points)
      marker.points.push_back(toPoint(point.cast<double>()));
  }
  return marker;
}

Marker MarkerMaker::labelMarker(std::size_t rank, const bin_picking::Detection& detection,
                                const OutputFrame& output) const
{
  // In front of the part as the camera sees it: at its origin the text would be inside.
  const Eigen::Vector3d center = detection.T_camera_object * models_.at(detection.model_index)->center;
  Pose T_camera_label = Pose::Identity();
  T_camera_label.translation() = center - 0.5 * models_[detection.model_index]->diameter * center.normalized();
  Marker marker = makeMarker(output.header, "labels", rank, Marker::TEXT_VIEW_FACING);
  marker.pose = toPoseMessage(output.T_output_camera * T_camera_label);
  marker.scale.z = 0.012;
  marker.color = toColor({1.0f, 1.0f, 1.0f}, 1.0f);
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%zu: %.2f", rank, detection.score);
  marker.text = std::string(text.data()) + (detection.undetermined_turn ? ", turn open" : "");
  return marker;
}

void MarkerMaker::addDetections(const PickResult& result, const OutputFrame& output, MarkerArray& markers) const
{
  for (std::size_t rank = 0; rank < result.detection.detections.size(); ++rank)
  {
    const bin_picking::Detection& detection = result.detection.detections[rank];
    markers.markers.push_back(partMarker(detection, output));
    markers.markers.back().id = static_cast<std::int32_t>(rank);
    markers.markers.back().color = toColor(bin_picking::rankColor(rank), 1.0f);
    markers.markers.push_back(labelMarker(rank, detection, output));
  }
  for (std::size_t i = 0; i < result.detection.rejected.size(); ++i)
  {
    markers.markers.push_back(partMarker(result.detection.rejected[i], output));
    markers.markers.back().ns = "rejected";
    markers.markers.back().id = static_cast<std::int32_t>(i);
    markers.markers.back().color = toColor({0.5f, 0.5f, 0.5f}, 0.3f);
  }
}

MarkerArray MarkerMaker::make(const PickResult& result, const OutputFrame& output) const
{
  MarkerArray markers = noMarkers(output.header);
  if (result.bin)
    markers.markers.push_back(binMarker(*result.bin, output));
  addDetections(result, output, markers);
  if (!result.selection.grasps.empty())
    addGrasp(result.selection.grasps.front(), grippers_.find(result.gripper), output, markers);
  addRejectedGrasps(result.selection.rejected, output, markers);
  addAvoided(result.avoided, output, markers);
  return markers;
}
}  // namespace bin_picking_ros
