// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "marker_primitives.hpp"

#include <array>
#include <cmath>
#include <map>

namespace bin_picking_ros
{
using bin_picking::TriangleMesh;
using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

TriangleMesh simplifyForDisplay(const TriangleMesh& mesh, std::size_t max_triangles)
{
  if (mesh.triangles.size() <= max_triangles)
    return mesh;
  // With n cells along its diagonal, the surface of a compact part passes through about 2 n^2 cells, two triangles
  // each.
  const double cells = std::sqrt(static_cast<double>(max_triangles) / 4.0);
  const float cell = static_cast<float>(bin_picking::boundingBoxDiagonal(mesh.vertices) / cells);
  TriangleMesh result;
  std::map<std::array<std::int64_t, 3>, std::uint32_t> cluster_of_cell;
  std::vector<std::uint32_t> cluster(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
  {
    const Eigen::Vector3f& v = mesh.vertices[i];
    const std::array<std::int64_t, 3> key = {std::llround(v.x() / cell), std::llround(v.y() / cell),
                                             std::llround(v.z() / cell)};
    const auto [entry, is_new] = cluster_of_cell.emplace(key, static_cast<std::uint32_t>(result.vertices.size()));
    if (is_new)
      result.vertices.push_back(v);
    cluster[i] = entry->second;
  }
  for (const auto& triangle : mesh.triangles)
  {
    const std::array<std::uint32_t, 3> t = {cluster[triangle[0]], cluster[triangle[1]], cluster[triangle[2]]};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
      result.triangles.push_back(t);
  }
  return result;
}

geometry_msgs::Point toPoint(const Eigen::Vector3d& p)
{
  geometry_msgs::Point point;
  point.x = p.x();
  point.y = p.y();
  point.z = p.z();
  return point;
}

std_msgs::ColorRGBA toColor(const Eigen::Vector3f& rgb, float alpha)
{
  std_msgs::ColorRGBA color;
  color.r = rgb.x();
  color.g = rgb.y();
  color.b = rgb.z();
  color.a = alpha;
  return color;
}

Marker makeMarker(const std_msgs::Header& header, const char* name_space, std::size_t id, std::int32_t type)
{
  Marker marker;
  marker.header = header;
  marker.ns = name_space;
  marker.id = static_cast<std::int32_t>(id);
  marker.type = type;
  marker.action = Marker::ADD;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  return marker;
}

void addTriangles(const TriangleMesh& mesh, Marker& marker)
{
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle)
      marker.points.push_back(toPoint(mesh.vertices[vertex].cast<double>()));
}

MarkerArray noMarkers(const std_msgs::Header& header)
{
  MarkerArray markers;
  markers.markers.emplace_back();
  markers.markers.back().header = header;
  markers.markers.back().action = Marker::DELETEALL;
  markers.markers.back().pose.orientation.w = 1.0;
  return markers;
}
}  // namespace bin_picking_ros
