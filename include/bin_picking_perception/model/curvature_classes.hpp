// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/model/feature_table.hpp"
#include "bin_picking_perception/model/training_parameters.hpp"

namespace bin_picking
{
/// Low- and high-curvature ranges of Equation 8, in the unit of the measure, on the absolute value.
struct CurvatureClasses
{
  double low_max = 0;   ///< |q| <= low_max is "low"
  double high_min = 0;  ///< |q| > high_min is "high"

  int classOf(float q) const;  ///< -1 low, +1 high, 0 neither or NaN
};

/// The ranges that split the histogram of |q| into three classes of least variance within (Otsu with two thresholds).
/// NaN is left out. All values alike: both ranges are empty (low_max < 0, high_min infinite), nothing is weighted.
CurvatureClasses classesFromHistogram(const std::vector<float>& curvature);

/// Fills the curvature part of the quantizer: the given step, or, if it is 0, AUTOMATIC_CURVATURE_BINS equal bins
/// between the 5th and 95th percentile; one bin (four-dimensional features) where the part's curvature hardly varies.
/// \param scale what counts as "hardly": a tenth of it (1 / curvature radius, or 1 for the normal variation)
void chooseCurvatureBins(FeatureQuantizer& quantizer, const std::vector<float>& curvature, double step, double scale);

constexpr int AUTOMATIC_CURVATURE_BINS = 5;
constexpr int MAX_CURVATURE_BINS = 64;
}  // namespace bin_picking
