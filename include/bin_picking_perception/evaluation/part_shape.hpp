// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <map>
#include <string>
#include <vector>

#include "bin_picking_perception/evaluation/evaluation_dataset.hpp"
#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking
{
class Executor;

/// What the poses of a part are compared with.
struct PartShape
{
  TriangleMesh mesh;
  Symmetry symmetry;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< middle of the bounding box, part frame
  double diameter = 0;                               ///< metres
  /// The points farthest out in many directions. A rigid motion moves no point of a body more than the most moved
  /// corner of its convex hull, so that they give the largest distance (MSSD) of the whole surface.
  std::vector<Eigen::Vector3f> extreme_points;
  std::vector<Eigen::Vector3f> surface_points;  ///< even over the surface, for mean distances (ADD-S)
};

using PartShapes = std::map<std::string, PartShape>;  ///< by the part's name

/// \param diameter metres; 0: measured on the mesh. \throws ParameterError the mesh has no triangles
PartShape makePartShape(const TriangleMesh& mesh, const Symmetry& symmetry, double diameter = 0);

/// The shapes of all parts of a data set; a part whose symmetry is not stated has that which training finds.
/// \throws FileError a mesh that cannot be used
PartShapes loadPartShapes(const EvaluationDataset& dataset, const Executor& executor);

/// Fills the visible fractions that the data set does not state, from the scan: a pixel of the instance's silhouette is
/// hidden if something was measured there more than `tolerance` (metres) in front of it; pixels without measurement
/// count as visible (scene_gt_info of the BOP toolkit, mode bop19, whose tolerance is 15 mm).
void estimateVisibility(EvaluationScene& scene, const DepthGrid& grid, const PartShapes& shapes,
                        double tolerance = 0.015);
}  // namespace bin_picking
