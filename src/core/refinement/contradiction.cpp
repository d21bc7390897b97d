// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "contradiction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bin_picking_perception/refinement/rivals.hpp"
#include "pixel_window.hpp"

namespace bin_picking
{
namespace
{
constexpr std::size_t MAX_SCENE_POINTS = 800;
constexpr std::size_t MAX_MODEL_POINTS = 400;
constexpr float OUTLIER = 9;  // squared: off by three halves of the tolerance is as wrong as anything
constexpr float NEAR = 0.7f;  // of the field's band: what lies nearer may belong to the part

PixelWindow windowAround(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid)
{
  constexpr double REACH = 0.65;  // of the diameter, round the part's middle: rivals stick out a little
  return {grid, T_camera_object * model.center, REACH * model.diameter, MAX_SCENE_POINTS};
}

/// Measured points around a pose, in the part's frame.
std::vector<Eigen::Vector3f> measuredAround(const TrainedModel& model, const Pose& T_camera_object,
                                            const DepthGrid& grid)
{
  const PixelWindow window = windowAround(model, T_camera_object, grid);
  const Eigen::Isometry3f T_object_camera = T_camera_object.inverse().cast<float>();
  std::vector<Eigen::Vector3f> points;
  for (int v = window.v_begin; v < window.v_end; v += window.step)
    for (int u = window.u_begin; u < window.u_end; u += window.step)
      if (grid.valid(grid.index(u, v)))
        points.push_back(T_object_camera * grid.point(grid.index(u, v)));
  return points;
}

/// The sensor looked through the point: everything measured on its ray and beside it lies behind.
bool isSeenThrough(const DepthGrid& grid, const Eigen::Vector3f& p, float limit)
{
  constexpr int AROUND[5][2] = {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  const PinholeCamera& camera = grid.camera;
  const float inverse_z = 1 / p.z();
  const float u = static_cast<float>(camera.fx) * p.x() * inverse_z + static_cast<float>(camera.cx) + 0.5f;
  const float v = static_cast<float>(camera.fy) * p.y() * inverse_z + static_cast<float>(camera.cy) + 0.5f;
  if (!(u >= 1 && v >= 1 && u < static_cast<float>(grid.width - 1) && v < static_cast<float>(grid.height - 1)))
    return false;
  const int middle = grid.index(static_cast<int>(u), static_cast<int>(v));
  return std::all_of(std::begin(AROUND), std::end(AROUND), [&](const int(&offset)[2]) {
    // false for NaN: nothing was measured
    const int pixel = middle + grid.index(offset[0], offset[1]);
    return grid.z[static_cast<std::size_t>(pixel)] >= p.z() + limit;
  });
}
}  // namespace

Contradiction::Contradiction(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid,
                             const DepthGrid& surroundings, double tolerance)
    : model_(model),
      T_camera_object_(T_camera_object),
      surroundings_(surroundings),
      tolerance_(tolerance),
      points_(measuredAround(model, T_camera_object, grid)),
      area_per_point_(std::pow(windowAround(model, T_camera_object, grid).step *
                                   grid.pitch((T_camera_object * model.center).z()) / model.parameters.leaf,
                               2))
{}

std::vector<double> Contradiction::ofAll(const std::vector<Pose>& turns)
{
  std::vector<double> against = offSurfaceOfAll(turns);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < turns.size(); ++k)
  {
    against[k] += seenThrough(turns[k], least + MOST_MARGIN - against[k]);
    least = std::min(least, against[k]);
  }
  return against;
}

double Contradiction::operator()(const Pose& turn) const
{
  double off = 0;
  const Eigen::Isometry3f T_turned_object = turn.inverse().cast<float>();
  for (const Eigen::Vector3f& p : points_)
    off += cost(model_.field.at(T_turned_object * p));
  return 0.5 * area_per_point_ * off + seenThrough(turn, std::numeric_limits<double>::infinity());
}

double Contradiction::cost(float distance) const
{
  const float residual = distance * static_cast<float>(2 / tolerance_);
  return static_cast<double>(std::min(residual * residual, OUTLIER));
}

std::vector<double> Contradiction::offSurfaceOfAll(const std::vector<Pose>& turns)
{
  std::vector<Eigen::Isometry3f> motions(turns.size());
  std::transform(turns.begin(), turns.end(), motions.begin(),
                 [](const Pose& turn) { return turn.inverse().cast<float>(); });
  std::vector<double> sums(turns.size(), 0);
  std::vector<double> costs(turns.size());
  std::vector<Eigen::Vector3f> concerned;
  for (const Eigen::Vector3f& p : points_)
  {
    float nearest = model_.field.band();
    for (std::size_t k = 0; k < motions.size(); ++k)
    {
      const float distance = model_.field.at(motions[k] * p);
      nearest = std::min(nearest, std::abs(distance));
      costs[k] = cost(distance);
    }
    if (nearest >= NEAR * model_.field.band())
      continue;
    concerned.push_back(p);
    for (std::size_t k = 0; k < sums.size(); ++k)
      sums[k] += costs[k];
  }
  points_ = std::move(concerned);
  for (double& sum : sums)
    sum *= 0.5 * area_per_point_;
  return sums;
}

double Contradiction::seenThrough(const Pose& turn, double enough) const
{
  constexpr float MIN_COSINE = 0.35f;  // flatter, the ray passes the silhouette
  const Eigen::Isometry3f T = (T_camera_object_ * turn).cast<float>();
  const auto limit = static_cast<float>(0.5 * model_.parameters.leaf + tolerance_);
  // The same points for all turns, so that their sampling does not tell them apart.
  const std::size_t step = std::max<std::size_t>(1, model_.surface.size() / MAX_MODEL_POINTS);
  const double spacing = model_.parameters.surface_spacing / model_.parameters.leaf;
  const double each = 0.5 * spacing * spacing * static_cast<double>(step) * static_cast<double>(OUTLIER);
  double sum = 0;
  for (std::size_t i = 0; i < model_.surface.size() && sum <= enough; i += step)
  {
    const Eigen::Vector3f p = T * model_.surface.points[i];
    const float towards = -(T.linear() * model_.surface.normals[i]).dot(p);
    if (p.z() > 0 && towards > 0 && towards * towards > MIN_COSINE * MIN_COSINE * p.squaredNorm() &&
        isSeenThrough(surroundings_, p, limit))
      sum += each;
  }
  return sum;
}

double surfaceShare(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid, double tolerance)
{
  int near = 0;
  int on_surface = 0;
  for (const Eigen::Vector3f& p : measuredAround(model, T_camera_object, grid))
  {
    const float distance = std::abs(model.field.at(p));
    near += distance < NEAR * model.field.band();
    on_surface += distance < static_cast<float>(tolerance);
  }
  return near > 0 ? static_cast<double>(on_surface) / near : 0;
}
}  // namespace bin_picking
