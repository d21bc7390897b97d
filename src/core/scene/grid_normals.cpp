// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <array>
#include <cmath>

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
using Sums = Eigen::Array<double, 8, 1>;

Sums momentsOf(double s, double t, double q)
{
  Sums sums;
  sums << s, t, q, s * s, s * t, t * t, s * q, t * q;
  return sums;
}

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
  NormalEstimator(const DepthGrid& grid, double radius)
      : grid_(grid),
        runs_(connectedRuns(grid, EdgeRule())),
        pixels_per_inverse_depth_(radius / grid.pitch(1.0)),
        max_window_(largestWindow()),
        discs_(max_window_)
  {}

  /// Fills the normals of one tile.
  void estimate(int tile_u, int tile_v, std::vector<Eigen::Vector3f>& normals) const
  {
    const int u0 = tile_u * TILE_WIDTH;
    const int v0 = tile_v * TILE_HEIGHT;
    const int u1 = std::min(grid_.width, u0 + TILE_WIDTH);
    const int v1 = std::min(grid_.height, v0 + TILE_HEIGHT);
    const RunningSums sums(*this, {std::max(0, u0 - max_window_), std::min(grid_.width, u1 + max_window_),
                                   std::max(0, v0 - max_window_), std::min(grid_.height, v1 + max_window_)});
    for (int v = v0; v < v1; ++v)
      for (int u = u0; u < u1; ++u)
        if (const int i = grid_.index(u, v); grid_.valid(i))
          normals[static_cast<std::size_t>(i)] = normalAt(u, v, sums);
  }

private:
  struct Area
  {
    int u_begin, u_end, v_begin, v_end;
  };

  /// Sums over the pixels left of each pixel, per row of an area.
  class RunningSums
  {
  public:
    RunningSums(const NormalEstimator& estimator, const Area& area)
        : area_(area), stride_(area.u_end - area.u_begin + 1)
    {
      const DepthGrid& grid = estimator.grid_;
      const PinholeCamera& c = grid.camera;
      reference = {(area.u_begin - c.cx) / c.fx, (area.v_begin - c.cy) / c.fy, 0};
      sums_.resize(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(area.v_end - area.v_begin));
      bool has_depth = false;
      for (int v = area.v_begin; v < area.v_end; ++v)
      {
        Sums sum = Sums::Zero();
        at(area.u_begin, v) = sum;
        for (int u = area.u_begin; u < area.u_end; ++u)
        {
          if (const int i = grid.index(u, v); grid.valid(i))
          {
            const Eigen::Vector3d p = grid.point(i).cast<double>();
            const double q = 1 / p.z();
            if (!has_depth)
              reference.q = q;
            has_depth = true;
            sum += momentsOf(p.x() * q - reference.s, p.y() * q - reference.t, q - reference.q);
          }
          at(u + 1, v) = sum;
        }
      }
    }
    const Sums& at(int u, int v) const { return sums_[offset(u, v)]; }

    Reference reference;

  private:
    std::size_t offset(int u, int v) const
    {
      return static_cast<std::size_t>(v - area_.v_begin) * static_cast<std::size_t>(stride_) +
             static_cast<std::size_t>(u - area_.u_begin);
    }
    Sums& at(int u, int v) { return sums_[offset(u, v)]; }

    Area area_;
    int stride_;
    std::vector<Sums, Eigen::aligned_allocator<Sums>> sums_;
  };

  int window(float z) const
  {
    return std::clamp(static_cast<int>(std::lround(pixels_per_inverse_depth_ / static_cast<double>(z))), 1, MAX_WINDOW);
  }

  int largestWindow() const
  {
    int largest = 1;
    for (const float z : grid_.z)
      if (!std::isnan(z))
        largest = std::max(largest, window(z));
    return largest;
  }

  Eigen::Vector3f normalAt(int u, int v, const RunningSums& running) const
  {
    const auto i = static_cast<std::size_t>(grid_.index(u, v));
    const int w = window(grid_.z[i]);
    const int* half_width = discs_.rows(w);
    Sums sums = Sums::Zero();
    int n = 0;
    const int up = std::min<int>(w, runs_.up[i]);
    const int down = std::min<int>(w, runs_.down[i]);
    for (int k = -up; k <= down; ++k)
    {
      const auto row = static_cast<std::size_t>(grid_.index(u, v + k));
      const int left = std::min<int>(half_width[std::abs(k)], runs_.left[row]);
      const int right = std::min<int>(half_width[std::abs(k)], runs_.right[row]);
      sums += running.at(u + right + 1, v + k) - running.at(u - left, v + k);
      n += left + right + 1;
    }
    return planeNormal(sums, n, running.reference);
  }

  const DepthGrid& grid_;
  ConnectedRuns runs_;
  double pixels_per_inverse_depth_;
  int max_window_;
  Discs discs_;
};
}  // namespace

std::vector<Eigen::Vector3f> estimateGridNormals(const DepthGrid& grid, double radius, const Executor& executor)
{
  std::vector<Eigen::Vector3f> normals(grid.size(), Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  const NormalEstimator estimator(grid, radius);
  const int tiles_u = (grid.width + TILE_WIDTH - 1) / TILE_WIDTH;
  const int tiles_v = (grid.height + TILE_HEIGHT - 1) / TILE_HEIGHT;
  executor.forEach(static_cast<std::size_t>(tiles_u) * static_cast<std::size_t>(tiles_v), [&](std::size_t tile) {
    const auto k = static_cast<int>(tile);
    estimator.estimate(k % tiles_u, k / tiles_u, normals);
  });
  return normals;
}
}  // namespace bin_picking
