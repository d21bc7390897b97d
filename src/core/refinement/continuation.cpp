// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "bin_picking_perception/refinement/verification.hpp"

namespace bin_picking
{
namespace
{
constexpr double STEP_BEYOND = 1;   // leaves in the picture: farther off, another part may lie alike by chance
constexpr float FARTHEST = 1.5f;    // leaves in space: beyond, it is not beside it
constexpr float MIN_DROP = 2;       // leaves: a lower step is one that a pose which is a little off has moved
constexpr float SAME_SIDE = 0.76f;  // cosine of 40 degrees: the other side of a thin wall has the opposite normal
constexpr float PARALLEL = 0.9f;    // cosine of 26 degrees: straight on, not round a crease

/// A point of the part as the camera would see it, part frame.
struct Predicted
{
  Eigen::Vector3f point;
  Eigen::Vector3f ray;  ///< from the camera, of length 1
  float cosine;         ///< between the normal and the ray to the camera: its share of the picture
  int u;
  int v;
};

/// A point of the part's surface next to what was measured there, part frame.
struct Explained
{
  Eigen::Vector3f point;
  Eigen::Vector3f normal;
};

/// What was measured around a part, as the part sees it.
class MeasuredSurface
{
public:
  MeasuredSurface(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid,
                  const std::vector<Eigen::Vector3f>& normals, double tolerance)
      : model_(model),
        grid_(grid),
        normals_(normals),
        T_object_camera_(T_camera_object.inverse().cast<float>()),
        leaf_(static_cast<float>(model.parameters.leaf)),
        tolerance_(static_cast<float>(tolerance)),
        around_(std::max(1, static_cast<int>(std::lround(STEP_BEYOND * model.parameters.leaf /
                                                         grid.pitch((T_camera_object * model.center).z())))))
  {}

  /// Whether there is a measurement with a normal.
  bool has(int u, int v) const
  {
    return grid_.inside(u, v) && grid_.valid(grid_.index(u, v)) && !std::isnan(normalAt(u, v).x());
  }

  /// Whether the part explains the measurement, and by which point of its surface.
  bool isExplained(int u, int v, Explained& surface) const
  {
    const Eigen::Vector3f p = pointAt(u, v);
    const DistanceField::Sample sample = model_.field.sample(p);
    if (std::abs(sample.distance) >= tolerance_)
      return false;
    surface.normal = sample.gradient.normalized();
    surface.point = p - sample.distance * surface.normal;
    return normalAt(u, v).dot(surface.normal) > SAME_SIDE;
  }

  /// Whether the measurement lies well in front of the point, outside of the part, and yet in a plane that touches the
  /// part where it explains what was measured beside.
  bool continuesBefore(const Predicted& hidden) const
  {
    const Eigen::Vector3f p = pointAt(hidden.u, hidden.v);
    if ((hidden.point - p).dot(hidden.ray) * hidden.cosine < MIN_DROP * leaf_)
      return false;
    const float distance = model_.field.at(p);
    return distance >= tolerance_ && distance < model_.field.band() && isInPlaneBeside(hidden.u, hidden.v, p);
  }

private:
  bool isInPlaneBeside(int u, int v, const Eigen::Vector3f& p) const
  {
    const Eigen::Vector3f normal = normalAt(u, v);
    for (int y = v - around_; y <= v + around_; ++y)
      for (int x = u - around_; x <= u + around_; ++x)
      {
        Explained beside;
        if (!has(x, y) || (pointAt(x, y) - p).squaredNorm() > 2 * FARTHEST * FARTHEST * leaf_ * leaf_ ||
            !isExplained(x, y, beside))
          continue;
        const Eigen::Vector3f d = p - beside.point;
        if (std::abs(beside.normal.dot(d)) < tolerance_ && normal.dot(beside.normal) > PARALLEL &&
            d.squaredNorm() < FARTHEST * FARTHEST * leaf_ * leaf_)
          return true;
      }
    return false;
  }

  Eigen::Vector3f pointAt(int u, int v) const { return T_object_camera_ * grid_.point(grid_.index(u, v)); }
  Eigen::Vector3f normalAt(int u, int v) const
  {
    return T_object_camera_.linear() * normals_[static_cast<std::size_t>(grid_.index(u, v))];
  }

  const TrainedModel& model_;
  const DepthGrid& grid_;
  const std::vector<Eigen::Vector3f>& normals_;
  Eigen::Isometry3f T_object_camera_;
  float leaf_;
  float tolerance_;
  int around_;  ///< pixels that are "beside" one, to every side
};

Predicted predict(const TrainedModel& model, std::uint32_t index, const Pose& T_camera_object,
                  const Eigen::Vector3f& camera, const DepthGrid& grid)
{
  Predicted predicted;
  predicted.point = model.surface.points[index];
  predicted.ray = (predicted.point - camera).normalized();
  predicted.cosine = -model.surface.normals[index].dot(predicted.ray);
  const Eigen::Vector2d pixel = grid.camera.project(T_camera_object * predicted.point.cast<double>());
  predicted.u = static_cast<int>(std::lround(pixel.x()));
  predicted.v = static_cast<int>(std::lround(pixel.y()));
  return predicted;
}
}  // namespace

double continuedShare(const TrainedModel& model, const SurfaceIndices& visible, const Pose& T_camera_object,
                      const DepthGrid& grid, const std::vector<Eigen::Vector3f>& normals, double tolerance)
{
  const MeasuredSurface measured(model, T_camera_object, grid, normals, tolerance);
  const Eigen::Vector3f camera = T_camera_object.inverse().translation().cast<float>();
  double explained = 0;
  double continued = 0;
  for (const std::uint32_t i : visible)
  {
    const Predicted point = predict(model, i, T_camera_object, camera, grid);
    Explained surface;
    if (!(point.cosine > 0) || !measured.has(point.u, point.v))
      continue;
    const auto weight = static_cast<double>(point.cosine);
    if (measured.isExplained(point.u, point.v, surface))
      explained += weight;
    else if (measured.continuesBefore(point))
      continued += weight;
  }
  return explained > 0 ? continued / explained : 0;
}
}  // namespace bin_picking
