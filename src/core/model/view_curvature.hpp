// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "part_views.hpp"

namespace bin_picking
{
/// Curvature of a part's points as the scene's own code measures it: in rendered views, where a fit sees one side of
/// the part only and smooths its edges. The all-round fit differs from that around thin walls and edges by several
/// bins.
struct ViewCurvature
{
  /// Per point over the views that see its whole neighbourhood; if none does, over those that see the point; NaN if
  /// none does either.
  std::vector<float> mean;
  /// Robust standard deviation of single views that see the whole neighbourhood, in the unit of the measure; 0: not
  /// known, no point has two. Views have no noise and measure the model's own points: scenes repeat it less well.
  double repeatability = 0;
};

/// \param num_points of the model
ViewCurvature curvatureInViews(const std::vector<PartView>& views, std::size_t num_points);
}  // namespace bin_picking
