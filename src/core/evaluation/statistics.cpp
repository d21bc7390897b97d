// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bin_picking
{
double Ratio::value() const
{
  return total > 0 ? static_cast<double>(hits) / total : std::numeric_limits<double>::quiet_NaN();
}

Interval Ratio::interval() const
{
  if (total == 0)
    return {0, 1};
  constexpr double Z = 1.959963984540054;  // of 95 %, two-sided
  const double n = total;
  const double p = value();
  const double middle = p + Z * Z / (2 * n);
  const double reach = Z * std::sqrt(p * (1 - p) / n + Z * Z / (4 * n * n));
  const double scale = 1 + Z * Z / n;
  // Exact at the ends, where rounding would leave 1e-17.
  return {hits == 0 ? 0.0 : (middle - reach) / scale, hits == total ? 1.0 : (middle + reach) / scale};
}

double percentile(std::vector<double> values, double share)
{
  if (values.empty())
    return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double position = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (position - static_cast<double>(below)) * (values[above] - values[below]);
}

Spread spread(const std::vector<double>& values)
{
  return {percentile(values, 0.5), percentile(values, 0.95), static_cast<int>(values.size())};
}

std::optional<double> averagePrecision(std::vector<ScoredOutcome> outcomes, int positives)
{
  if (positives <= 0)
    return std::nullopt;
  std::sort(outcomes.begin(), outcomes.end(),
            [](const ScoredOutcome& a, const ScoredOutcome& b) { return a.score > b.score; });
  std::vector<Ratio> steps;  // right among all, after each score
  Ratio sofar;
  for (std::size_t k = 0; k < outcomes.size(); ++k)
  {
    sofar.count(outcomes[k].right);
    if (k + 1 == outcomes.size() || outcomes[k + 1].score < outcomes[k].score)
      steps.push_back(sofar);
  }
  double area = 0;
  double best_precision = 0;
  for (std::size_t k = steps.size(); k-- > 0;)
  {
    best_precision = std::max(best_precision, steps[k].value());
    const int hits_before = k > 0 ? steps[k - 1].hits : 0;
    area += best_precision * (steps[k].hits - hits_before) / positives;
  }
  return area;
}
}  // namespace bin_picking
