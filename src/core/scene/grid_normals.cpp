// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "../common/simd.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"

// On the ray (s, t, 1) of a pixel, s = x / z and t = y / z, a plane A x + B y + C z = 1 has the inverse depth
// q = A s + B t + C. The fit is linear and its errors are along the rays, as those of a depth sensor are. The
// neighbourhood of a pixel is what can be reached by going up or down its column and then along a row, within a square
// and without crossing a depth edge: running sums along the rows give the moments of each pixel's piece of its row, and
// running sums of these down the columns give those of the neighbourhood, whatever its size.

namespace bin_picking
{
namespace
{
constexpr int TILE_WIDTH = 128;
constexpr int TILE_HEIGHT = 32;
constexpr int MAX_WINDOW = 64;  // pixels; a larger radius is cut
/// Half the side of the square that has the area of a disc, per radius of the disc: sqrt(pi) / 2.
constexpr float SQUARE_PER_RADIUS = 0.886227f;
constexpr double MIN_PLANE_PIXELS = 5;
/// Smallest ratio of the determinant to the squared trace of the window's spread; below, its pixels lie on a line.
constexpr double MIN_SPREAD = 0.002;

/// s, t, q, ss, st, tt, sq, tq, relative to a reference ray for accuracy.
using Sums = std::array<double, 8>;

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

/// Pieces of rows or columns: what comes after `before` up to `last`, as places in running sums.
struct Spans
{
  std::array<int, TILE_WIDTH> before;
  std::array<int, TILE_WIDTH> last;
};

/// How the size of a neighbourhood follows from the depth.
struct Window
{
  float pixels_per_inverse_depth;

  /// Half its side; 1 where there is no depth.
  int at(float z) const
  {
    const float half = pixels_per_inverse_depth / z + 0.5f;
    return static_cast<int>(half > 1 ? (half < MAX_WINDOW ? half : static_cast<float>(MAX_WINDOW)) : 1.0f);
  }
};

/// The pieces around `count` neighbouring pixels, the first of which has a place in the running sums. \param before,
/// after connected pixels on either side \param step from one place to the next of a piece
BIN_PICKING_SIMD void findSpans(const float* z, const std::uint8_t* before, const std::uint8_t* after, int count,
                                const Window& given, int place, int step, Spans& spans)
{
  const Window window = given;
  for (int k = 0; k < count; ++k)
  {
    const int reach = window.at(z[k]);
    const int back = before[k] < reach ? before[k] : reach;
    const int on = after[k] < reach ? after[k] : reach;
    spans.before[static_cast<std::size_t>(k)] = place + k - back * step;
    spans.last[static_cast<std::size_t>(k)] = place + k + (on + 1) * step;
  }
}

/// sums[k] = start[k] + what lies in the k-th span
BIN_PICKING_SIMD void addSpans(const Sums* running, const Spans& spans, std::size_t count, const Sums* start,
                               Sums* sums)
{
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t m = 0; m < 8; ++m)
      sums[k][m] = start[k][m] + (running[spans.last[k]][m] - running[spans.before[k]][m]);
}

/// Normals of the planes that fit; NaN where no plane does.
BIN_PICKING_SIMD void fitPlanes(const Sums* sums, const int* pixels, std::size_t count, const Reference& given,
                                Eigen::Vector3f* normals)
{
  const Reference reference = given;
  for (std::size_t k = 0; k < count; ++k)
  {
    const Sums& m = sums[k];
    const auto n = static_cast<double>(pixels[k]);
    const double s = m[0] / n;
    const double t = m[1] / n;
    const double q = m[2] / n;
    const double ss = m[3] - m[0] * s;
    const double st = m[4] - m[0] * t;
    const double tt = m[5] - m[1] * t;
    const double sq = m[6] - m[0] * q;
    const double tq = m[7] - m[1] * q;
    const double determinant = ss * tt - st * st;
    const bool plane = n >= MIN_PLANE_PIXELS && determinant >= MIN_SPREAD * (ss + tt) * (ss + tt);
    const double a = (tt * sq - st * tq) / determinant;
    const double b = (ss * tq - st * sq) / determinant;
    const double c = q + reference.q - a * (s + reference.s) - b * (t + reference.t);
    // The origin lies on the side of the plane where A x + B y + C z < 1: minus the gradient points to the camera.
    const double scale = plane ? -1 / std::sqrt(a * a + b * b + c * c) : std::numeric_limits<double>::quiet_NaN();
    normals[k] = {static_cast<float>(scale * a), static_cast<float>(scale * b), static_cast<float>(scale * c)};
  }
}

class NormalEstimator
{
public:
  NormalEstimator(const DepthGrid& grid, const ConnectedRuns& runs, double radius)
      : grid_(grid),
        runs_(runs),
        window_{SQUARE_PER_RADIUS * static_cast<float>(radius / grid.pitch(1.0))},
        max_window_(largestWindow())
  {}

  /// Fills the normals of one tile.
  void estimate(int tile_u, int tile_v, std::vector<Eigen::Vector3f>& normals) const
  {
    const Area tile = measuredPart({tile_u * TILE_WIDTH, std::min(grid_.width, (tile_u + 1) * TILE_WIDTH),
                                    tile_v * TILE_HEIGHT, std::min(grid_.height, (tile_v + 1) * TILE_HEIGHT)});
    if (tile.u_begin >= tile.u_end)
      return;
    const Reference reference = firstRay(tile);
    const ColumnSums columns = sumColumns(tile, reference);
    const int width = tile.u_end - tile.u_begin;
    const auto count = static_cast<std::size_t>(width);
    constexpr std::array<Sums, TILE_WIDTH> NONE{};
    Spans spans;
    std::array<int, TILE_WIDTH> pixels;
    std::array<Sums, TILE_WIDTH> sums;
    std::array<Eigen::Vector3f, TILE_WIDTH> fitted;
    for (int v = tile.v_begin; v < tile.v_end; ++v)
    {
      const auto i = static_cast<std::size_t>(grid_.index(tile.u_begin, v));
      findSpans(&grid_.z[i], &runs_.up[i], &runs_.down[i], width, window_, (v - columns.first) * width, width, spans);
      addSpans(columns.sums.get(), spans, count, NONE.data(), sums.data());
      for (std::size_t k = 0; k < count; ++k)
        pixels[k] = columns.pixels[static_cast<std::size_t>(spans.last[k])] -
                    columns.pixels[static_cast<std::size_t>(spans.before[k])];
      fitPlanes(sums.data(), pixels.data(), count, reference, fitted.data());
      for (std::size_t k = 0; k < count; ++k)
        if (grid_.z[i + k] > 0)
          normals[i + k] = fitted[k];
    }
  }

private:
  struct Area
  {
    int u_begin, u_end, v_begin, v_end;
  };

  /// Per row of a tile and of what lies around it, sums over the rows above; row by row, a place per column.
  struct ColumnSums
  {
    int first = 0;  ///< row
    std::unique_ptr<Sums[]> sums;
    std::vector<int> pixels;
  };

  ColumnSums sumColumns(const Area& tile, const Reference& reference) const
  {
    const Area area = around(tile);
    const int width = tile.u_end - tile.u_begin;
    const auto count = static_cast<std::size_t>(width);
    const auto places = count * static_cast<std::size_t>(area.v_end - area.v_begin + 1);
    ColumnSums columns;
    columns.first = area.v_begin;
    columns.sums.reset(new Sums[places]);  // not set to 0, as a vector's would be: each is written below
    columns.pixels.resize(places);
    std::fill_n(columns.sums.get(), width, Sums{});
    std::vector<Sums> row(static_cast<std::size_t>(area.u_end - area.u_begin) + 1);
    Spans spans;
    for (int v = area.v_begin; v < area.v_end; ++v)
    {
      const auto begin = static_cast<std::size_t>(grid_.index(area.u_begin, v));
      sumRow(&grid_.x[begin], &grid_.y[begin], &grid_.z[begin], row.size() - 1, reference, row.data());
      const auto i = static_cast<std::size_t>(grid_.index(tile.u_begin, v));
      findSpans(&grid_.z[i], &runs_.left[i], &runs_.right[i], width, window_, tile.u_begin - area.u_begin, 1, spans);
      const std::size_t above = static_cast<std::size_t>(v - area.v_begin) * count;
      addSpans(row.data(), spans, count, &columns.sums[above], &columns.sums[above + count]);
      for (std::size_t k = 0; k < count; ++k)
        columns.pixels[above + count + k] = columns.pixels[above + k] + spans.last[k] - spans.before[k];
    }
    return columns;
  }

  /// The smallest area that holds all measured pixels of another one.
  Area measuredPart(const Area& area) const
  {
    Area part{area.u_end, area.u_begin, area.v_end, area.v_begin};
    for (int v = area.v_begin; v < area.v_end; ++v)
      for (int u = area.u_begin; u < area.u_end; ++u)
        if (grid_.valid(grid_.index(u, v)))
          part = {std::min(part.u_begin, u), std::max(part.u_end, u + 1), std::min(part.v_begin, v), v + 1};
    return part;
  }

  /// Of a measured pixel in the first row of an area.
  Reference firstRay(const Area& area) const
  {
    int i = grid_.index(area.u_begin, area.v_begin);
    while (!grid_.valid(i))
      ++i;
    const Eigen::Vector3d p = grid_.point(i).cast<double>();
    return {p.x() / p.z(), p.y() / p.z(), 1 / p.z()};
  }

  Area around(const Area& tile) const
  {
    return {std::max(0, tile.u_begin - max_window_), std::min(grid_.width, tile.u_end + max_window_),
            std::max(0, tile.v_begin - max_window_), std::min(grid_.height, tile.v_end + max_window_)};
  }

  int largestWindow() const
  {
    float nearest = std::numeric_limits<float>::infinity();
    for (const float z : grid_.z)
      nearest = z < nearest ? z : nearest;
    return window_.at(nearest);
  }

  const DepthGrid& grid_;
  const ConnectedRuns& runs_;
  Window window_;
  int max_window_;
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
