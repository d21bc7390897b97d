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

constexpr int MIN_AUTOMATIC_CURVATURE_BINS = 3;  ///< fewer sort out too little
constexpr int MAX_AUTOMATIC_CURVATURE_BINS = 5;  ///< more, and scenes often miss the model's bin
constexpr int MAX_CURVATURE_BINS = 64;
/// Of 1 / curvature radius, or of 1 for the normal variation: a part that varies by less has one curvature.
constexpr double MIN_CURVATURE_RANGE = 0.1;

/// From the 5th to the 95th percentile; NaN is left out.
double curvatureRange(const std::vector<float>& curvature);

/// Bins of four standard deviations of a measurement in this range, at most MAX_AUTOMATIC_CURVATURE_BINS; so many where
/// the repeatability is not known (0).
int distinguishableBins(double range, double repeatability);

/// Fills the curvature part of the quantizer: the given step, or, if it is 0, so many equal bins between the 5th and
/// 95th percentile; one bin (four-dimensional features) where the part's curvature hardly varies.
/// \param scale of which less than MIN_CURVATURE_RANGE is "hardly"
void chooseCurvatureBins(FeatureQuantizer& quantizer, const std::vector<float>& curvature, double step, double scale,
                         int automatic_bins = MAX_AUTOMATIC_CURVATURE_BINS);
}  // namespace bin_picking
