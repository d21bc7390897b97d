// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking::paper
{
struct ColoredCloud
{
  OrientedPoints points;
  Eigen::Vector3f color;  ///< red, green, blue in [0, 1]
};

/// Clouds in the camera frame, shaded, as an upright camera in front of their middle sees them; PNG. Where two lie on
/// each other within a hair, pixels alternate, as in a mixture of two real clouds. \throws FileError
void saveCloudPicture(const std::vector<ColoredCloud>& clouds, const std::string& file);

/// Red for the largest values, blue for the smallest, as in the paper's Figure 7. \param level in [0, 1]
Eigen::Vector3f heat(double level);

/// The points of a grid with normals, camera frame. \param keep per pixel; empty: all
OrientedPoints pointsOf(const DepthGrid& grid, const std::vector<bool>& keep);

/// \param gray row by row. \throws FileError
void saveGray(const std::vector<std::uint8_t>& gray, int width, int height, const std::string& file);

/// Each label in a colour of its own, 0 black.
void saveLabels(const std::vector<std::int32_t>& labels, int width, int height, const std::string& file);
}  // namespace bin_picking::paper
