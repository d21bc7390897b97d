// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "view_curvature.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bin_picking
{
namespace
{
constexpr double SD_OF_MEDIAN = 1.4826;  // standard deviation per median deviation of a normal distribution

struct Values
{
  std::vector<float> complete;
  std::vector<float> cut_off;  ///< by an occlusion edge
};

float meanOf(const std::vector<float>& values)
{
  double sum = 0;
  for (const float value : values)
    sum += static_cast<double>(value);
  return values.empty() ? std::numeric_limits<float>::quiet_NaN()
                        : static_cast<float>(sum / static_cast<double>(values.size()));
}
}  // namespace

ViewCurvature curvatureInViews(const std::vector<PartView>& views, std::size_t num_points)
{
  std::vector<Values> values(num_points);
  for (const PartView& view : views)
    for (std::size_t k = 0; k < view.points.size(); ++k)
      if (!std::isnan(view.samples.curvature[k]))
      {
        Values& own = values[view.points[k]];
        (view.samples.curvature_complete[k] ? own.complete : own.cut_off).push_back(view.samples.curvature[k]);
      }

  ViewCurvature result;
  std::vector<float> deviations;
  for (const Values& own : values)
  {
    result.mean.push_back(meanOf(own.complete.empty() ? own.cut_off : own.complete));
    if (own.complete.size() < 2)
      continue;
    const auto n = static_cast<float>(own.complete.size());
    const float from_own_mean = std::sqrt(n / (n - 1));  // deviations from the mean of few are too small
    for (const float value : own.complete)
      deviations.push_back(from_own_mean * std::abs(value - result.mean.back()));
  }
  if (!deviations.empty())
  {
    const auto middle = deviations.begin() + static_cast<std::ptrdiff_t>(deviations.size() / 2);
    std::nth_element(deviations.begin(), middle, deviations.end());
    result.repeatability = SD_OF_MEDIAN * static_cast<double>(*middle);
  }
  return result;
}
}  // namespace bin_picking
