// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "virtual_cell_messages.hpp"

#include <sensor_msgs/distortion_models.h>

#include <array>
#include <cstring>
#include <utility>

#include "marker_primitives.hpp"
#include "pose_conversion.hpp"

namespace bin_picking_ros
{
using bin_picking::simulation::CellInstance;
using bin_picking::simulation::CellPart;

sensor_msgs::PointCloud2 toCloudMessage(const bin_picking::DepthGrid& grid, const std_msgs::Header& header)
{
  sensor_msgs::PointCloud2 message;
  message.header = header;
  message.width = static_cast<std::uint32_t>(grid.width);
  message.height = static_cast<std::uint32_t>(grid.height);
  for (const char* name : {"x", "y", "z"})
  {
    sensor_msgs::PointField field;
    field.name = name;
    field.offset = static_cast<std::uint32_t>(message.fields.size() * sizeof(float));
    field.datatype = sensor_msgs::PointField::FLOAT32;
    field.count = 1;
    message.fields.push_back(field);
  }
  message.point_step = 3 * sizeof(float);
  message.row_step = message.point_step * message.width;
  message.is_bigendian = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__ ? 1 : 0;
  message.is_dense = 0;
  message.data.resize(grid.size() * message.point_step);
  for (std::size_t i = 0; i < grid.size(); ++i)
  {
    const std::array<float, 3> point = {grid.x[i], grid.y[i], grid.z[i]};
    std::memcpy(&message.data[i * message.point_step], point.data(), message.point_step);
  }
  return message;
}

sensor_msgs::CameraInfo toCameraInfo(const bin_picking::DepthGrid& grid, const std_msgs::Header& header)
{
  const bin_picking::PinholeCamera& c = grid.camera;
  sensor_msgs::CameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(grid.width);
  info.height = static_cast<std::uint32_t>(grid.height);
  info.distortion_model = sensor_msgs::distortion_models::PLUMB_BOB;
  info.D.assign(5, 0.0);
  info.K = {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {c.fx, 0, c.cx, 0, 0, c.fy, c.cy, 0, 0, 0, 1, 0};
  return info;
}

bin_picking_perception::SceneTruth toTruthMessage(const std::vector<CellInstance>& instances,
                                                  const std::vector<CellPart>& parts, const std_msgs::Header& header)
{
  bin_picking_perception::SceneTruth truth;
  truth.header = header;
  for (const CellInstance& instance : instances)
  {
    bin_picking_perception::TrueInstance message;
    message.id = instance.id;
    message.part = parts.at(static_cast<std::size_t>(instance.part)).name;
    message.pose = toPoseMessage(instance.T_camera_object);
    message.visible_fraction = instance.view.visible_fraction;
    message.visible_pixels = instance.view.visible_pixels;
    message.valid_pixels = instance.view.valid_pixels;
    truth.instances.push_back(message);
  }
  return truth;
}

visualization_msgs::MarkerArray toTruthMarkers(const std::vector<CellInstance>& instances,
                                               const std::vector<bin_picking::TriangleMesh>& meshes,
                                               const std_msgs::Header& header)
{
  visualization_msgs::MarkerArray markers = noMarkers(header);
  for (const CellInstance& instance : instances)
  {
    visualization_msgs::Marker ghost =
        makeMarker(header, "truth", static_cast<std::size_t>(instance.id), visualization_msgs::Marker::TRIANGLE_LIST);
    ghost.pose = toPoseMessage(instance.T_camera_object);
    ghost.color = toColor({0.6f, 0.8f, 1.0f}, 0.35f);
    addTriangles(meshes.at(static_cast<std::size_t>(instance.part)), ghost);
    markers.markers.push_back(std::move(ghost));
  }
  return markers;
}
}  // namespace bin_picking_ros
