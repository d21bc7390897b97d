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
constexpr float LARGE = 0.008f;      // metres: radius up to which many points are passed over together
constexpr float TOUCH = 0.001f;      // metres: once something is about to touch, only what is as near matters

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
      columns_(surface, way_object_, LOOK_AHEAD + LARGE + spacing),
      in_sight_(within(LOOK_AHEAD + spacing)),
      touching_(within(TOUCH + spacing)),
      of_spheres_(within(LOOK_AHEAD + LARGE + spacing))
{
  for (std::size_t k = 0; k < 8; ++k)
    corners_.emplace_back(corners_[k] + motion_camera.cast<float>());
  for (const Eigen::Vector3f& corner : corners_)
    box_.extend(corner);
}

/// On which a sphere at rest reaches into the part's box.
HeldPart::Stretch HeldPart::stretchInBox(const Eigen::Vector3f& center, float radius) const
{
  Stretch stretch{0, length_};
  for (int axis = 0; axis < 3; ++axis)
  {
    const float low = surface_.box().min()[axis] - radius - center[axis];
    const float high = surface_.box().max()[axis] + radius - center[axis];
    if (std::abs(way_object_[axis]) < 1e-6f)
    {
      if (low > 0 || high < 0)
        return {0, -1};
      continue;
    }
    const float at_low = low * per_way_[axis];
    const float at_high = high * per_way_[axis];
    stretch.from = std::max(stretch.from, std::min(at_low, at_high));
    stretch.to = std::min(stretch.to, std::max(at_low, at_high));
  }
  return stretch;
}

/// On which a point is near, or may be.
HeldPart::Stretch HeldPart::stretchNear(const Eigen::Vector3f& center, const Near& near) const
{
  const ColumnSpans::Span span = near.columns.at(center);
  const float at_rest = center.dot(way_object_);
  return {std::max(0.0f, span.begin - near.distance - at_rest), std::min(length_, span.end + near.distance - at_rest)};
}

bool HeldPart::mayMeetInObject(const Sphere& points) const
{
  if (points.radius <= LARGE && stretchNear(points.center, of_spheres_).isEmpty())
    return false;
  return !stretchInBox(points.center, points.radius).isEmpty();
}

/// Where on the way a point may be near. \param room only what comes nearer matters, metres
HeldPart::Stretch HeldPart::whereNear(const Eigen::Vector3f& point, float room) const
{
  const Stretch near = stretchNear(point, room < TOUCH ? touching_ : in_sight_);
  if (near.isEmpty())
    return near;
  const Stretch in_box = stretchInBox(point, 0);
  return {std::max(near.from, in_box.from), std::min(near.to, in_box.to)};
}

/// How much deeper the point gets into the part than it is at the start: <= 0 not at all. Each step is as long as the
/// distance from the surface allows. Ends where it is more than max_drag: farther on it may be deeper.
float HeldPart::deepening(const Eigen::Vector3f& point, const Stretch& near) const
{
  const auto atRest = [&] { return std::min(0.0f, field_.at(point)); };  // what is not inside does not ask
  float nearest = field_.band();
  for (float way = near.from;;)
  {
    const float distance = field_.at(point + way * way_object_);
    if (!(distance >= -max_drag_) && !(distance >= atRest() - max_drag_))  // too deep, or not a number
      return atRest() - distance;
    nearest = std::min(nearest, distance);
    if (way >= near.to)
      break;
    way = std::min(way + std::max(distance, MIN_STEP), near.to);
  }
  return nearest < 0 ? atRest() - nearest : -nearest;
}

void HeldPart::meet(const SurfaceBlocks& other, const Pose& T_camera_other, int index, Encounter& worst) const
{
  const Eigen::Isometry3f T_object_other = T_object_camera_ * Eigen::Isometry3f(T_camera_other.cast<float>());
  const Eigen::Isometry3f T_camera(T_camera_other.cast<float>());
  const auto isOwn = [] { return false; };
  for (const SurfaceBlocks::Block& block : other.blocks())
  {
    if (!mayMeetInObject({T_object_other * block.around.center, block.around.radius}))
      continue;
    for (std::size_t k = block.begin; k < block.end; ++k)
      meet(T_camera * other.point(k), ObstacleKind::Part, index, isOwn, worst);
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
    Planes moved;
    toFrame(T_object_camera_.inverse(), planes, moved);
    return moved;
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
