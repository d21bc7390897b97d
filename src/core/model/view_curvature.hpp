// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/model/trained_model.hpp"

namespace bin_picking
{
/// Curvature of a part's points as the scene's own code measures it: in rendered views, where a fit sees one side of
/// the part only and smooths its edges. The all-round fit differs from that around thin walls and edges by several
/// bins.
struct ViewCurvature
{
  std::vector<float>
      mean;  ///< per point over the views that see its whole neighbourhood (if none, that see it); or NaN
  double repeatability = 0;  ///< robust standard deviation of single views about the mean, in the unit of the measure
};

/// \param model its mesh, points, normals and parameters are used
/// \param pixel of the views, metres: that of the scene's working grid
ViewCurvature curvatureInViews(const TrainedModel& model, double pixel, const Executor& executor);
}  // namespace bin_picking
