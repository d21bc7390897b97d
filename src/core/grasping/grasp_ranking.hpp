// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/grasping/grasp.hpp"
#include "bin_picking_perception/grasping/grasp_parameters.hpp"

namespace bin_picking
{
/// A grasp with what its quality is made of.
struct GraspCandidate
{
  Grasp grasp;
  double score = 0;      ///< of the detection, [0, 1]
  double uncovered = 1;  ///< share of the part that nothing lies on, [0, 1]
  double priority = 1;   ///< among the grasps of the part, [0, 1]
  double height = 0;     ///< of the grasp point along "up", metres, from any fixed level
};

/// Fills in the quality and sorts, best first. Equal quality (to 1e-6) keeps the order of the input.
std::vector<Grasp> rankGrasps(std::vector<GraspCandidate> candidates, const GraspParameters& parameters);
}  // namespace bin_picking
