// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/detector.hpp"

namespace bin_picking
{
/// Writes the depth picture with the found parts over it, coloured by rank (red, orange, yellow, green, blue as in the
/// paper's Figure 16, then violet), each with its rank and score. PNG or JPEG by the file's ending.
/// \throws FileError cannot be written
void saveDetectionPicture(const DepthGrid& grid, const DetectionResult& result,
                          const std::vector<std::shared_ptr<const TrainedModel>>& models, const std::string& path);

/// Colour of a rank (0 = best) as red, green, blue in [0, 1].
Eigen::Vector3f rankColor(std::size_t rank);
}  // namespace bin_picking
