// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "held_part.hpp"

#include <algorithm>
#include <cmath>

namespace bin_picking
{
namespace
{
constexpr float MIN_STEP = 0.0005f;  // metres: where a point is about to touch

Eigen::Vector3f wayOfOthers(const Eigen::Vector3d& motion)
{
  return (motion.norm() > 0 ? Eigen::Vector3d(-motion.normalized()) : Eigen::Vector3d::UnitZ()).cast<float>();
}
}  // namespace

HeldPart::HeldPart(const DistanceField& field, const SurfaceBlocks& surface, float spacing, const Pose& T_camera_object,
                   const Eigen::Vector3d& motion_camera, float max_drag)
    : field_(field),
      surface_(surface),
      T_object_camera_(T_camera_object.inverse().cast<float>()),
      way_object_(T_object_camera_.linear() * wayOfOthers(motion_camera)),
      per_way_(way_object_.cwiseInverse()),
      length_(static_cast<float>(motion_camera.norm())),
      max_drag_(max_drag),
      motion_camera_(motion_camera),
      corners_(cornersOf(surface.box(), Eigen::Isometry3f(T_camera_object.cast<float>()))),
      tops_(surface, way_object_, LOOK_AHEAD + spacing)
{
  for (std::size_t k = 0; k < 8; ++k)
    corners_.emplace_back(corners_[k] + motion_camera.cast<float>());
  for (const Eigen::Vector3f& corner : corners_)
    box_.extend(corner);
}

bool HeldPart::passes(const Eigen::Vector3f& center, float radius, float& from, float& to) const
{
  from = 0;
  to = length_;
  for (int axis = 0; axis < 3; ++axis)
  {
    const float low = surface_.box().min()[axis] - radius - center[axis];
    const float high = surface_.box().max()[axis] + radius - center[axis];
    if (std::abs(way_object_[axis]) < 1e-6f)
    {
      if (low > 0 || high < 0)
        return false;
      continue;
    }
    const float at_low = low * per_way_[axis];
    const float at_high = high * per_way_[axis];
    from = std::max(from, std::min(at_low, at_high));
    to = std::min(to, std::max(at_low, at_high));
  }
  return from <= to;
}

/// How much deeper the point gets into the part than it is at the start: <= 0 not at all. Each step is as long as the
/// distance from the surface allows. Ends where it is more than max_drag: farther on it may be deeper.
float HeldPart::deepening(const Eigen::Vector3f& point) const
{
  float from = 0;
  float to = 0;
  if (!mayMeet(point) || !passes(point, 0, from, to))
    return -field_.band();
  const float at_rest = std::min(0.0f, field_.at(point));
  float nearest = field_.band();
  for (float way = from; way <= to;)
  {
    const float distance = field_.at(point + way * way_object_);
    if (!(distance >= at_rest - max_drag_))  // too deep, or not a number
      return at_rest - distance;
    nearest = std::min(nearest, distance);
    way += std::max(distance, MIN_STEP);
  }
  return at_rest - nearest;
}

void HeldPart::meet(const Eigen::Vector3f& point_camera, ObstacleKind kind, int index, Encounter& worst) const
{
  const float deeper = deepening(T_object_camera_ * point_camera);
  keepWorse(worst, {-deeper, -max_drag_, kind, index, point_camera});
}

void HeldPart::meet(const SurfaceBlocks& other, const Pose& T_camera_other, int index, Encounter& worst) const
{
  const Eigen::Isometry3f T_object_other = T_object_camera_ * Eigen::Isometry3f(T_camera_other.cast<float>());
  const Eigen::Isometry3f T_camera(T_camera_other.cast<float>());
  float from = 0;
  float to = 0;
  for (const SurfaceBlocks::Block& block : other.blocks())
  {
    if (!passes(T_object_other * block.center, block.radius, from, to))
      continue;
    for (std::size_t k = block.begin; k < block.end; ++k)
    {
      const float deeper = deepening(T_object_other * other.point(k));
      if (!(deeper - max_drag_ <= -worst.margin()))
        keepWorse(worst, {-deeper, -max_drag_, ObstacleKind::Part, index, T_camera * other.point(k)});
    }
    if (!worst.free())
      return;
  }
}

void HeldPart::meetSide(const ConvexBody& side, ObstacleKind kind, int index, Encounter& worst) const
{
  // Seen from the part, the side moves the other way: all that it covers is convex.
  const auto toObject = [&](const ConvexBody& body) {
    Planes planes;
    for (const Eigen::Vector4d& plane : body.planes)
      planes.push_back(plane.cast<float>());
    return inFrame(planes, T_object_camera_.inverse());
  };
  Encounter at_rest;
  Encounter on_the_way;
  at_rest.distance = on_the_way.distance = LOOK_AHEAD;
  surface_.deepest(toObject(swept(side, -motion_camera_)), on_the_way.distance, on_the_way.contact);
  if (on_the_way.distance >= LOOK_AHEAD)
    return;
  surface_.deepest(toObject(side), at_rest.distance, at_rest.contact);
  const float deeper = std::min(0.0f, at_rest.distance) - on_the_way.distance;
  keepWorse(worst, {-deeper, -max_drag_, kind, index, T_object_camera_.inverse() * on_the_way.contact});
}
}  // namespace bin_picking
