// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <cstddef>
#include <cstdint>

#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking_ros
{
constexpr std::size_t MAX_DISPLAY_TRIANGLES = 3000;  ///< per part: 25 parts stay below 6 MB

/// A mesh with at most about `max_triangles` triangles for display: vertices that share a cell of a grid become one. A
/// small mesh is returned as it is.
bin_picking::TriangleMesh simplifyForDisplay(const bin_picking::TriangleMesh& mesh, std::size_t max_triangles);

geometry_msgs::Point toPoint(const Eigen::Vector3d& p);
std_msgs::ColorRGBA toColor(const Eigen::Vector3f& rgb, float alpha);

/// At the origin of the header's frame, of scale 1, without colour.
visualization_msgs::Marker makeMarker(const std_msgs::Header& header, const char* name_space, std::size_t id,
                                      std::int32_t type);

/// The triangles of a mesh, for a marker of type TRIANGLE_LIST.
void addTriangles(const bin_picking::TriangleMesh& mesh, visualization_msgs::Marker& marker);

/// Only the removal of all earlier markers.
visualization_msgs::MarkerArray noMarkers(const std_msgs::Header& header);
}  // namespace bin_picking_ros
