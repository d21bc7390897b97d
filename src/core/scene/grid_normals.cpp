// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <array>
#include <cmath>

#include "../common/simd.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"

// On the ray (s, t, 1) of a pixel, s = x / z and t = y / z, a plane A x + B y + C z = 1 has the inverse depth
// q = A s + B t + C. The fit is linear and its errors are along the rays, as those of a depth sensor are. The
// neighbourhood of a pixel is what can be reached by going up or down its column and then along a row, within a disc
// and without crossing a depth edge. Each row of it is a run of pixels, so that running sums along the rows give its
// moments.

namespace bin_picking
{
namespace
{
constexpr int TILE_WIDTH = 128;
constexpr int TILE_HEIGHT = 32;
constexpr int MAX_WINDOW = 64;  // pixels; a larger radius is cut
constexpr double MIN_PLANE_PIXELS = 5;
/// Smallest ratio of the determinant to the squared trace of the window's spread; below, its pixels lie on a line.
constexpr double MIN_SPREAD = 0.002;

/// s, t, q, ss, st, tt, sq, tq, relative to a reference ray for accuracy.
using Sums = std::array<double, 8>;

/// Half the width of each row of a disc, for all disc sizes.
class Discs
{
public:
  explicit Discs(int max_window)
  {
    for (int w = 0; w <= max_window; ++w)
    {
      begin_.push_back(half_width_.size());
      for (int k = 0; k <= w; ++k)
        half_width_.push_back(static_cast<int>(std::sqrt((w + 0.5) * (w + 0.5) - k * k)));
    }
  }
  const int* rows(int window) const { return &half_width_[begin_[static_cast<std::size_t>(window)]]; }

private:
  std::vector<std::size_t> begin_;
  std::vector<int> half_width_;
};

struct Reference
{
  double s = 0;
  double t = 0;
  double q = 0;
};

/// Replaces the moments of the pixels of a row by their running sums; what was not measured counts nothing.
BIN_PICKING_SIMD void sumRow(const float* x, const float* y, const float* z, std::size_t count, const Reference& given,
                             Sums* sums)
{
  const Reference reference = given;
  for (std::size_t k = 0; k < count; ++k)
  {
    const bool measured = z[k] > 0;  // false for NaN
    const double depth = static_cast<double>(z[k]);
    const double s = measured ? static_cast<double>(x[k]) / depth - reference.s : 0;
    const double t = measured ? static_cast<double>(y[k]) / depth - reference.t : 0;
    const double q = measured ? 1 / depth - reference.q : 0;
    sums[k + 1] = {s, t, q, s * s, s * t, t * t, s * q, t * q};
  }
  sums[0].fill(0);
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t m = 0; m < 8; ++m)
      sums[k + 1][m] += sums[k][m];
}

/// Pixels of one row of a neighbourhood: those after `before` up to `last`, as places in the running sums.
struct Span
{
  std::size_t before;
  std::size_t last;
};

BIN_PICKING_SIMD void sumSpans(const Sums* running, const Span* spans, std::size_t count, Sums& result)
{
  double sums[8] = {};
  for (std::size_t k = 0; k < count; ++k)
  {
    const double* last = running[spans[k].last].data();
    const double* before = running[spans[k].before].data();
    for (std::size_t m = 0; m < 8; ++m)
      sums[m] += last[m] - before[m];
  }
  std::copy(sums, sums + 8, result.begin());
}

Eigen::Vector3f planeNormal(const Sums& sums, double n, const Reference& reference)
{
  const double s = sums[0] / n;
  const double t = sums[1] / n;
  const double q = sums[2] / n;
  const double ss = sums[3] - sums[0] * s;
  const double st = sums[4] - sums[0] * t;
  const double tt = sums[5] - sums[1] * t;
  const double sq = sums[6] - sums[0] * q;
  const double tq = sums[7] - sums[1] * q;
  const double determinant = ss * tt - st * st;
  if (n < MIN_PLANE_PIXELS || determinant < MIN_SPREAD * (ss + tt) * (ss + tt))
    return Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  const double a = (tt * sq - st * tq) / determinant;
  const double b = (ss * tq - st * sq) / determinant;
  const double c = q + reference.q - a * (s + reference.s) - b * (t + reference.t);
  // The origin lies on the side of the plane where A x + B y + C z < 1: minus the gradient points to the camera.
  return (-Eigen::Vector3d(a, b, c).normalized()).cast<float>();
}

class NormalEstimator
{
public:
  NormalEstimator(const DepthGrid& grid, const ConnectedRuns& runs, double radius)
      : grid_(grid),
        runs_(runs),
        pixels_per_inverse_depth_(radius / grid.pitch(1.0)),
        max_window_(largestWindow()),
        discs_(max_window_)
  {}

  /// Fills the normals of one tile.
  void estimate(int tile_u, int tile_v, std::vector<Eigen::Vector3f>& normals) const
  {
    const Area tile{tile_u * TILE_WIDTH, std::min(grid_.width, (tile_u + 1) * TILE_WIDTH), tile_v * TILE_HEIGHT,
                    std::min(grid_.height, (tile_v + 1) * TILE_HEIGHT)};
    const int measured = firstMeasured(tile);
    if (measured < 0)
      return;
    const RunningSums sums(grid_, around(tile), referenceAt(measured));
    for (int v = tile.v_begin; v < tile.v_end; ++v)
      for (int u = tile.u_begin; u < tile.u_end; ++u)
        if (const int i = grid_.index(u, v); grid_.valid(i))
          normals[static_cast<std::size_t>(i)] = normalAt(u, v, sums);
  }

private:
  struct Area
  {
    int u_begin, u_end, v_begin, v_end;
  };

  /// Sums over the pixels left of each pixel, per row of an area.
  struct RunningSums
  {
    RunningSums(const DepthGrid& grid, const Area& the_area, const Reference& the_reference)
        : reference(the_reference), area(the_area), stride(area.u_end - area.u_begin + 1)
    {
      sums.resize(static_cast<std::size_t>(stride) * static_cast<std::size_t>(area.v_end - area.v_begin));
      for (int v = area.v_begin; v < area.v_end; ++v)
      {
        const auto i = static_cast<std::size_t>(grid.index(area.u_begin, v));
        sumRow(&grid.x[i], &grid.y[i], &grid.z[i], static_cast<std::size_t>(stride - 1), reference,
               &sums[place(area.u_begin, v)]);
      }
    }
    std::size_t place(int u, int v) const
    {
      return static_cast<std::size_t>((v - area.v_begin) * stride + u - area.u_begin);
    }

    Reference reference;
    Area area;
    int stride;
    std::vector<Sums> sums;
  };

  /// Index of a measured pixel in the area; -1 if there is none.
  int firstMeasured(const Area& area) const
  {
    for (int v = area.v_begin; v < area.v_end; ++v)
      for (int u = area.u_begin; u < area.u_end; ++u)
        if (grid_.valid(grid_.index(u, v)))
          return grid_.index(u, v);
    return -1;
  }

  Reference referenceAt(int pixel) const
  {
    const Eigen::Vector3d p = grid_.point(pixel).cast<double>();
    return {p.x() / p.z(), p.y() / p.z(), 1 / p.z()};
  }

  Area around(const Area& tile) const
  {
    return {std::max(0, tile.u_begin - max_window_), std::min(grid_.width, tile.u_end + max_window_),
            std::max(0, tile.v_begin - max_window_), std::min(grid_.height, tile.v_end + max_window_)};
  }

  int window(float z) const
  {
    return std::clamp(static_cast<int>(pixels_per_inverse_depth_ / static_cast<double>(z) + 0.5), 1, MAX_WINDOW);
  }

  int largestWindow() const
  {
    float nearest = std::numeric_limits<float>::infinity();
    for (const float z : grid_.z)
      nearest = z < nearest ? z : nearest;
    return window(nearest);
  }

  Eigen::Vector3f normalAt(int u, int v, const RunningSums& running) const
  {
    const auto i = static_cast<std::size_t>(grid_.index(u, v));
    const int w = window(grid_.z[i]);
    const int* half_width = discs_.rows(w);
    const int up = std::min<int>(w, runs_.up[i]);
    const int down = std::min<int>(w, runs_.down[i]);
    std::array<Span, 2 * MAX_WINDOW + 1> spans;
    std::size_t rows = 0;
    int n = 0;
    for (int k = -up; k <= down; ++k)
    {
      const auto row = static_cast<std::size_t>(grid_.index(u, v + k));
      const int left = std::min<int>(half_width[std::abs(k)], runs_.left[row]);
      const int right = std::min<int>(half_width[std::abs(k)], runs_.right[row]);
      const std::size_t place = running.place(u, v + k);
      spans[rows++] = {place - static_cast<std::size_t>(left), place + static_cast<std::size_t>(right) + 1};
      n += left + right + 1;
    }
    Sums sums;
    sumSpans(running.sums.data(), spans.data(), rows, sums);
    return planeNormal(sums, n, running.reference);
  }

  const DepthGrid& grid_;
  const ConnectedRuns& runs_;
  double pixels_per_inverse_depth_;
  int max_window_;
  Discs discs_;
};
}  // namespace

std::vector<Eigen::Vector3f> estimateGridNormals(const DepthGrid& grid, const ConnectedRuns& runs, double radius,
                                                 const Executor& executor)
{
  std::vector<Eigen::Vector3f> normals(grid.size(), Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  const NormalEstimator estimator(grid, runs, radius);
  const int tiles_u = (grid.width + TILE_WIDTH - 1) / TILE_WIDTH;
  const int tiles_v = (grid.height + TILE_HEIGHT - 1) / TILE_HEIGHT;
  executor.forEach(static_cast<std::size_t>(tiles_u) * static_cast<std::size_t>(tiles_v), [&](std::size_t tile) {
    const auto k = static_cast<int>(tile);
    estimator.estimate(k % tiles_u, k / tiles_u, normals);
  });
  return normals;
}

std::vector<Eigen::Vector3f> estimateGridNormals(const DepthGrid& grid, double radius, const Executor& executor)
{
  return estimateGridNormals(grid, connectedRuns(grid, EdgeRule(), executor), radius, executor);
}
}  // namespace bin_picking
