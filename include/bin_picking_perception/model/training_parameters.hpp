// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/model/pair_feature.hpp"
#include "bin_picking_perception/scene/curvature.hpp"

namespace bin_picking
{
/// Parameters of the offline phase. 0 means "derived from the part" where the text says so; the trained model holds the
/// derived value.
struct TrainingParameters
{
  double leaf = 0;             // 0: 4 % of the diameter, at most 6 mm or 1.5 %
  double matching_leaf = 0;    // 0: 5 % of the diameter, at least the leaf
  double surface_spacing = 0;  // 0: half the leaf
  int seed = 1;
  double normal_radius = 0;  // 0: 1.3 leaf
  FeatureKind feature = FeatureKind::Auto;
  CurvatureMeasure curvature_measure = CurvatureMeasure::MeanCurvature;
  double curvature_radius = 0;  // 0: 3.3 leaf, as in the paper (10 mm at 3 mm)
  bool curvature_in_views = true;
  double d_dist = 0;                     // 0: 0.6 matching_leaf
  double d_angle = 0.20943951023931953;  // 12 degrees
  double d_cur = 0;                      // 0: from the spread of the part's curvature
  double low_curvature_max = 0;          // both 0: from the histogram of the part's curvature
  double high_curvature_min = 0;
  double min_pair_distance = 0;  // 0: 1.5 matching_leaf
  bool covisible_pairs = true;
  bool edge_pairs = true;
  bool fold_symmetry = true;
  int num_views = 128;
  // A keyway, a flat or a hexagon on a turned part: half of what a right pose may be off (EvaluationParameters), so
  // that a hand that fits one turn fits the others. A hidden branch, rib or wall stands out by more. Twice as much for
  // a SMALL_FEATURE.
  double slight_deviation = 0.05;

  void visit(ParameterVisitor& v);
};
}  // namespace bin_picking
