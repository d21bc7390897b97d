// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/evaluation/scene_judgement.hpp"

namespace bin_picking
{
/// Outer edges of a part in the picture, holes too, as the data of an SVG path in pixels of the scan.
struct Outline
{
  std::string path;                                  ///< empty: not in the picture
  Eigen::Vector2d anchor = Eigen::Vector2d::Zero();  ///< middle of its pixels, for a label
};

struct ScenePicture
{
  int width = 0;  ///< pixels of the scan
  int height = 0;
  std::string jpeg;                ///< the shaded depth, not larger than a report needs
  std::vector<Outline> estimates;  ///< as in JudgedScene
  std::vector<Outline> instances;  ///< of those without a hit; empty paths for the others
};

/// \throws ParameterError the grid has no pixels
ScenePicture drawScene(const DepthGrid& grid, const JudgedScene& scene, const PartShapes& shapes);
}  // namespace bin_picking
