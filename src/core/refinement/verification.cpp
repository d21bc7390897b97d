// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/refinement/verification.hpp"

#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/model/distance_field.hpp"

namespace bin_picking
{
const ViewTemplate& nearestView(const TrainedModel& model, const Pose& T_camera_object)
{
  const Eigen::Vector3f direction = (T_camera_object.inverse().translation() - model.center).normalized().cast<float>();
  const ViewTemplate* nearest = &model.views.front();
  float best = -2;
  for (const ViewTemplate& view : model.views)
    if (const float cosine = view.direction.dot(direction); cosine > best)
    {
      best = cosine;
      nearest = &view;
    }
  return *nearest;
}

FacingPoints::FacingPoints(const TrainedModel& model, std::size_t max_points) : model_(model)
{
  for (const ViewTemplate& view : model.views)
    of_views_.push_back(testPoints(model, thinned(view.visible, max_points)));
}

const TestPoints& FacingPoints::at(const Pose& T_camera_object) const
{
  return of_views_[static_cast<std::size_t>(&nearestView(model_, T_camera_object) - model_.views.data())];
}

SurfaceIndices facingPoints(const TrainedModel& model, const Pose& T_camera_object, std::size_t max_points)
{
  return thinned(nearestView(model, T_camera_object).visible, max_points);
}

double binPenetration(const OrientedPoints& surface, const Pose& T_camera_object, const Bin& bin)
{
  const Eigen::Isometry3f T_bin_object = (bin.T_camera_bin.inverse() * T_camera_object).cast<float>();
  const Eigen::Array3f size = bin.inner_size.cast<float>();
  float deepest = 0;
  for (const Eigen::Vector3f& point : surface.points)
  {
    const Eigen::Vector3f p = T_bin_object * point;
    deepest = std::max(deepest, -p.z());
    // What is outside of a wall but higher than its rim leans over it; what is just below may have come over it too.
    const float through_wall = (p.head<2>().array().abs() - 0.5f * size.head<2>()).maxCoeff();
    deepest = std::max(deepest, std::min(through_wall, size.z() - p.z()));
  }
  return static_cast<double>(deepest);
}

namespace
{
template <typename IsNear>
double shareNear(const Pose& T_camera_object, const std::vector<Eigen::Vector3f>& object_points, const IsNear& is_near)
{
  if (object_points.empty())
    return 0;
  const Eigen::Isometry3f T_object_camera = T_camera_object.inverse().cast<float>();
  const auto matched = std::count_if(object_points.begin(), object_points.end(),
                                     [&](const Eigen::Vector3f& point) { return is_near(T_object_camera * point); });
  return static_cast<double>(matched) / static_cast<double>(object_points.size());
}
}  // namespace

double matchingRate(const KdTree& model_surface, const Pose& T_camera_object,
                    const std::vector<Eigen::Vector3f>& object_points, double distance)
{
  const auto limit = static_cast<float>(distance);
  return shareNear(T_camera_object, object_points,
                   [&](const Eigen::Vector3f& point) { return model_surface.nearest(point, limit).index >= 0; });
}

double matchingRate(const DistanceField& surface, const Pose& T_camera_object,
                    const std::vector<Eigen::Vector3f>& object_points, double distance)
{
  const auto limit = static_cast<float>(distance);
  return shareNear(T_camera_object, object_points,
                   [&](const Eigen::Vector3f& point) { return std::abs(surface.at(point)) < limit; });
}
}  // namespace bin_picking
