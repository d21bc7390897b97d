// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"

namespace bin_picking
{
namespace
{
constexpr int HALF_WINDOW = 2;
constexpr int WINDOW_PIXELS = (2 * HALF_WINDOW + 1) * (2 * HALF_WINDOW + 1);
constexpr double DEGREES_OF_FREEDOM = WINDOW_PIXELS - 6;
constexpr int MAX_WINDOWS = 20000;

bool isFlatWindow(const DepthGrid& grid, const ConnectedRuns& runs, int u, int v)
{
  const auto centre = static_cast<std::size_t>(grid.index(u, v));
  bool whole = runs.up[centre] >= HALF_WINDOW && runs.down[centre] >= HALF_WINDOW;
  for (int k = -HALF_WINDOW; whole && k <= HALF_WINDOW; ++k)
  {
    const auto row = static_cast<std::size_t>(grid.index(u, v + k));
    whole = runs.left[row] >= HALF_WINDOW && runs.right[row] >= HALF_WINDOW;
  }
  return whole;
}

/// Products of the window's inverse depths with the polynomials up to the second order that are orthogonal on it.
struct WindowSums
{
  double one = 0;
  double u = 0;
  double v = 0;
  double uu = 0;  ///< u^2 less its mean
  double uv = 0;
  double vv = 0;
  double squares = 0;
};

/// Variance of the depth about the quadric that fits best. A plane would take the curvature of a slim part for noise;
/// inverse depth is linear in the pixel on a plane and smooth on what is curved.
double quadricVariance(const DepthGrid& grid, int u, int v)
{
  constexpr double MEAN_SQUARE = HALF_WINDOW * (HALF_WINDOW + 1) / 3.0;
  const double z0 = static_cast<double>(grid.z[static_cast<std::size_t>(grid.index(u, v))]);
  WindowSums s;
  for (int dv = -HALF_WINDOW; dv <= HALF_WINDOW; ++dv)
  {
    for (int du = -HALF_WINDOW; du <= HALF_WINDOW; ++du)
    {
      const double q = 1 / static_cast<double>(grid.z[static_cast<std::size_t>(grid.index(u + du, v + dv))]) - 1 / z0;
      s.one += q;
      s.u += q * du;
      s.v += q * dv;
      s.uu += q * (du * du - MEAN_SQUARE);
      s.uv += q * du * dv;
      s.vv += q * (dv * dv - MEAN_SQUARE);
      s.squares += q * q;
    }
  }
  // What each polynomial's square sums up to over the window of 5 x 5 pixels.
  constexpr double LINEAR = 50;
  constexpr double SQUARE = 70;
  constexpr double MIXED = 100;
  const double rest = s.squares - s.one * s.one / WINDOW_PIXELS - (s.u * s.u + s.v * s.v) / LINEAR -
                      (s.uu * s.uu + s.vv * s.vv) / SQUARE - s.uv * s.uv / MIXED;
  return std::max(0.0, rest) / DEGREES_OF_FREEDOM * std::pow(z0, 4);
}
}  // namespace

double estimateDepthNoise(const DepthGrid& grid, const ConnectedRuns& runs)
{
  const auto stride = static_cast<int>(std::sqrt(static_cast<double>(grid.size()) / MAX_WINDOWS)) + 1;
  std::vector<double> variances;
  for (int v = HALF_WINDOW; v + HALF_WINDOW < grid.height; v += stride)
    for (int u = HALF_WINDOW; u + HALF_WINDOW < grid.width; u += stride)
      if (isFlatWindow(grid, runs, u, v))
        variances.push_back(quadricVariance(grid, u, v));
  if (variances.empty())
    return 0;
  const auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
  std::nth_element(variances.begin(), middle, variances.end());
  // Median of a chi-square variable per degree of freedom (Wilson-Hilferty); creases and edges only spoil the upper
  // half.
  const double bias = std::pow(1 - 2 / (9 * DEGREES_OF_FREEDOM), 3);
  return std::sqrt(*middle / bias);
}
}  // namespace bin_picking
