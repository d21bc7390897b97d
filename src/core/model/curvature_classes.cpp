// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/curvature_classes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace bin_picking
{
namespace
{
constexpr int HISTOGRAM_BINS = 64;
constexpr double TAIL = 0.05;  // of the values at either end share the outermost bins

std::vector<float> sortedFinite(const std::vector<float>& values, bool absolute)
{
  std::vector<float> sorted;
  sorted.reserve(values.size());
  for (const float value : values)
    if (!std::isnan(value))
      sorted.push_back(absolute ? std::abs(value) : value);
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

double percentile(const std::vector<float>& sorted, double share)
{
  return static_cast<double>(sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))]);
}

/// Sums over bins, so that the variance between classes needs only differences.
struct Sums
{
  std::array<double, HISTOGRAM_BINS + 1> count{};
  std::array<double, HISTOGRAM_BINS + 1> value{};

  /// count * mean^2 of bins [from, to).
  double between(int from, int to) const
  {
    const auto a = static_cast<std::size_t>(from);
    const auto b = static_cast<std::size_t>(to);
    const double n = count[b] - count[a];
    const double sum = value[b] - value[a];
    return n > 0 ? sum * sum / n : 0;
  }
};
}  // namespace

int CurvatureClasses::classOf(float q) const
{
  const double magnitude = static_cast<double>(std::abs(q));
  if (magnitude <= low_max)
    return -1;
  return magnitude > high_min ? 1 : 0;
}

CurvatureClasses classesFromHistogram(const std::vector<float>& curvature)
{
  const std::vector<float> sorted = sortedFinite(curvature, true);
  constexpr double NONE = std::numeric_limits<double>::infinity();
  if (sorted.empty() || percentile(sorted, 0.99) <= 0)
    return {-1, NONE};
  const double width = percentile(sorted, 0.99) / HISTOGRAM_BINS;
  Sums sums;
  for (const float value : sorted)
  {
    const auto bin = static_cast<std::size_t>(std::min(static_cast<double>(value) / width, HISTOGRAM_BINS - 1.0));
    sums.count[bin + 1] += 1;
    sums.value[bin + 1] += static_cast<double>(bin) + 0.5;
  }
  for (std::size_t i = 1; i <= HISTOGRAM_BINS; ++i)
  {
    sums.count[i] += sums.count[i - 1];
    sums.value[i] += sums.value[i - 1];
  }
  double best = sums.between(0, HISTOGRAM_BINS) * (1 + 1e-9);
  CurvatureClasses classes{-1, NONE};
  for (int low = 1; low < HISTOGRAM_BINS - 1; ++low)
    for (int high = low + 1; high < HISTOGRAM_BINS; ++high)
    {
      const double variance = sums.between(0, low) + sums.between(low, high) + sums.between(high, HISTOGRAM_BINS);
      if (variance > best)
      {
        best = variance;
        classes = {low * width, high * width};
      }
    }
  return classes;
}

double curvatureRange(const std::vector<float>& curvature)
{
  const std::vector<float> sorted = sortedFinite(curvature, false);
  return sorted.empty() ? 0 : percentile(sorted, 1 - TAIL) - percentile(sorted, TAIL);
}

int distinguishableBins(double range, double repeatability)
{
  constexpr double STEP = 4;  // standard deviations: three quarters of all measurements stay in their bin
  if (!(repeatability > 0))
    return MAX_AUTOMATIC_CURVATURE_BINS;
  return static_cast<int>(std::clamp(range / (STEP * repeatability), 1.0, 1.0 * MAX_AUTOMATIC_CURVATURE_BINS));
}

void chooseCurvatureBins(FeatureQuantizer& quantizer, const std::vector<float>& curvature, double step, double scale,
                         int automatic_bins)
{
  const std::vector<float> sorted = sortedFinite(curvature, false);
  quantizer.curvature_bins = 1;
  quantizer.curvature_step = step > 0 ? step : scale;
  quantizer.curvature_min = 0;
  if (sorted.empty())
    return;
  const double margin = step > 0 ? 0.01 : TAIL;
  const double low = percentile(sorted, margin);
  const double high = percentile(sorted, 1 - margin);
  if (step <= 0 && high - low < MIN_CURVATURE_RANGE * scale)
    return;
  quantizer.curvature_step = step > 0 ? step : (high - low) / automatic_bins;
  quantizer.curvature_min = step > 0 ? std::floor(low / step) * step : low;
  const double bins = std::ceil((high - quantizer.curvature_min) / quantizer.curvature_step - 1e-9);
  quantizer.curvature_bins = static_cast<int>(std::min(std::max(bins, 1.0), static_cast<double>(MAX_CURVATURE_BINS)));
}
}  // namespace bin_picking
