// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
struct VerificationParameters
{
  bool enabled = true;                // false: only the matching rate decides (paper)
  double match_distance = 0.005;      // Equation 9: distance threshold
  double min_matching_rate = 0.5;
  double depth_tolerance = 0.4;       // of the leaf, added to 3 sigma of the noise
  double max_normal_angle = 0.7;      // rad
  double min_visible_fraction = 0.3;
  double min_inlier_share = 0.55;     // explained / (explained + contradicted)
  double max_violation_share = 0.25;  // free space that was seen through the part
  double overlap = 0.35;              // share of common pixels from which two detections are one

  void visit(ParameterVisitor& v);
};

/// Point counts of a pose held against the grid.
struct PoseEvidence
{
  int facing = 0;      ///< model points that would be seen if nothing were in front
  int explained = 0;   ///< measured there, normal agrees
  int misfit = 0;      ///< measured near there, normal disagrees
  int occluded = 0;    ///< something nearer was measured: neither for nor against
  int violated = 0;    ///< something farther was measured: the part cannot be there
  int unmeasured = 0;  ///< no data: neither for nor against
  double rms = 0;      ///< depth residual of the explained points, metres
  std::vector<int> pixels;  ///< of the explained points, sorted, unique
};

PoseEvidence gatherEvidence(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid,
                            const std::vector<Eigen::Vector3f>& normals, double depth_tolerance,
                            const VerificationParameters& parameters);

/// Equation 9: the share of `object_points` that have a model point within `distance`.
double matchingRate(const OrientedPoints& model_surface, const Pose& T_camera_object,
                    const std::vector<Eigen::Vector3f>& object_points, double distance);
}  // namespace bin_picking
