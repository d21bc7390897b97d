// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "contradiction.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "bin_picking_perception/refinement/rivals.hpp"
#include "moved_points.hpp"
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

constexpr std::size_t LOOKS = 16;       // that the points are divided into
constexpr std::size_t FIRST_LOOKS = 4;  // which tell what is out of the question

/// Every sixteenth point, then those half-way between them, and so on: the points of the first looks lie all over the
/// place.
std::vector<Eigen::Vector3f> inLooks(const std::vector<Eigen::Vector3f>& points)
{
  constexpr std::size_t FIRST_OF_LOOK[LOOKS] = {0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15};
  std::vector<Eigen::Vector3f> ordered;
  ordered.reserve(points.size());
  for (const std::size_t first : FIRST_OF_LOOK)
    for (std::size_t i = first; i < points.size(); i += LOOKS)
      ordered.push_back(points[i]);
  return ordered;
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
      points_(inLooks(measuredAround(model, T_camera_object, grid))),
      area_per_point_(std::pow(windowAround(model, T_camera_object, grid).step *
                                   grid.pitch((T_camera_object * model.center).z()) / model.parameters.leaf,
                               2))
{}

std::vector<double> Contradiction::ofAll(const std::vector<Pose>& turns)
{
  std::vector<Turn> likely(turns.size());
  for (std::size_t k = 0; k < turns.size(); ++k)
    likely[k] = {k, turns[k].inverse().cast<float>(), 0};
  std::vector<Eigen::Vector3f> concerned;
  for (std::size_t look = 0; look < LOOKS && !likely.empty(); ++look)
  {
    addOffSurface(look * points_.size() / LOOKS, (look + 1) * points_.size() / LOOKS, likely, concerned);
    // What lags by half the margin after a quarter of the points, lags by twice the margin in the end.
    dropHopeless(likely, look < FIRST_LOOKS ? MOST_MARGIN / 2 : MOST_MARGIN);
  }
  points_ = std::move(concerned);

  std::vector<double> against(turns.size(), std::numeric_limits<double>::infinity());
  double least = std::numeric_limits<double>::infinity();
  for (const Turn& turn : likely)
  {
    const double enough = least + MOST_MARGIN - turn.off_surface;
    against[turn.index] = turn.off_surface + seenThrough(turns[turn.index], enough);
    least = std::min(least, against[turn.index]);
  }
  // The others were not looked through: none of them may pass for the best.
  std::replace(against.begin(), against.end(), std::numeric_limits<double>::infinity(), least + MOST_MARGIN);
  return against;
}

void Contradiction::dropHopeless(std::vector<Turn>& turns, double lag)
{
  const auto less = [](const Turn& a, const Turn& b) { return a.off_surface < b.off_surface; };
  const double limit = std::min_element(turns.begin(), turns.end(), less)->off_surface + lag;
  turns.erase(std::remove_if(turns.begin(), turns.end(), [&](const Turn& turn) { return turn.off_surface >= limit; }),
              turns.end());
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

void Contradiction::addOffSurface(std::size_t begin, std::size_t end, std::vector<Turn>& turns,
                                  std::vector<Eigen::Vector3f>& concerned) const
{
  std::vector<DistanceField::Numbers> distances(turns.size());
  DistanceField::Places places;
  for (; begin < end; begin += DistanceField::BLOCK)
  {
    const std::size_t count = std::min(DistanceField::BLOCK, end - begin);
    DistanceField::Numbers nearest;
    nearest.fill(model_.field.band());
    for (std::size_t k = 0; k < turns.size(); ++k)
    {
      movePoints(points_[begin].data(), count, Motion(turns[k].T_turned_object), places);
      model_.field.at(places, distances[k]);
      for (std::size_t i = 0; i < nearest.size(); ++i)
        nearest[i] = std::min(nearest[i], std::abs(distances[k][i]));
    }
    for (std::size_t i = 0; i < count; ++i)
    {
      if (nearest[i] >= NEAR * model_.field.band())
        continue;
      concerned.push_back(points_[begin + i]);
      for (std::size_t k = 0; k < turns.size(); ++k)
        turns[k].off_surface += 0.5 * area_per_point_ * cost(distances[k][i]);
    }
  }
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
