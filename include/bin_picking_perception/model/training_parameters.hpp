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
  double leaf = 0;
  double surface_spacing = 0;
  int seed = 1;
  double normal_radius = 0;
  FeatureKind feature = FeatureKind::CurPpf;
  CurvatureMeasure curvature_measure = CurvatureMeasure::MeanCurvature;
  double curvature_radius = 0;
  double d_dist = 0;
  double d_angle = 0.20943951;  // 12 degrees
  double d_cur = 0;
  double low_curvature_max = 0;
  double high_curvature_min = 0;
  double min_pair_distance = 0;
  bool covisible_pairs = true;
  int num_views = 162;

  void visit(ParameterVisitor& v);
};
}  // namespace bin_picking
