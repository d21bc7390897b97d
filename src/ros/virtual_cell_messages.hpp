// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <bin_picking_perception/SceneTruth.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/PointCloud2.h>
#include <visualization_msgs/MarkerArray.h>

#include <vector>

#include "virtual_cell.hpp"

namespace bin_picking_ros
{
/// Organized, x, y, z as float32 in metres, NaN where nothing was measured.
sensor_msgs::PointCloud2 toCloudMessage(const bin_picking::DepthGrid& grid, const std_msgs::Header& header);

/// A camera without distortion.
sensor_msgs::CameraInfo toCameraInfo(const bin_picking::DepthGrid& grid, const std_msgs::Header& header);

bin_picking_perception::SceneTruth toTruthMessage(const std::vector<bin_picking::simulation::CellInstance>& instances,
                                                  const std::vector<bin_picking::simulation::CellPart>& parts,
                                                  const std_msgs::Header& header);

/// The parts as transparent ghosts where they truly lie; begins with the removal of all earlier markers.
/// \param meshes of the parts, for display
visualization_msgs::MarkerArray toTruthMarkers(const std::vector<bin_picking::simulation::CellInstance>& instances,
                                               const std::vector<bin_picking::TriangleMesh>& meshes,
                                               const std_msgs::Header& header);
}  // namespace bin_picking_ros
