// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "held_part.hpp"

#include <algorithm>
#include <cmath>

namespace bin_picking
{
namespace
{
constexpr float MIN_STEP = 0.0005f;  // metres: where a point is about to get too deep
constexpr float LARGE = 0.008f;      // metres: radius up to which many points are passed over together

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
      columns_(surface, way_object_, LARGE + spacing),
      of_points_(within(spacing)),
      of_spheres_(within(LARGE + spacing))
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

/// Whether none of the points within the sphere gets into the part anywhere on the way; if not, they may still.
bool HeldPart::staysOutside(const Sphere& points) const
{
  Stretch inside = stretchInBox(points.center, points.radius);
  if (points.radius <= LARGE)
  {
    const Stretch near = stretchNear(points.center, of_spheres_);
    inside = {std::max(inside.from, near.from), std::min(inside.to, near.to)};
  }
  for (float way = inside.from; way <= inside.to;)
  {
    const float room = field_.at(points.center + way * way_object_) - points.radius;
    if (!(room >= 0))
      return false;
    if (way == inside.to)
      break;
    way = std::min(way + std::max(room, MIN_STEP), inside.to);
  }
  return true;
}

/// By how much the point gets deeper into the part than it is at the start, where that is more than max_drag for the
/// first time; 0: nowhere. What the shortest step may miss is less than half of it.
float HeldPart::deepening(const Eigen::Vector3f& point) const
{
  const Stretch near = stretchNear(point, of_points_);
  if (near.isEmpty())
    return 0;
  const Stretch in_box = stretchInBox(point, 0);
  const float end = std::min(near.to, in_box.to);
  const auto atRest = [&] { return std::min(0.0f, field_.at(point)); };  // what is not inside does not ask
  for (float way = std::max(near.from, in_box.from); way <= end;)
  {
    const float distance = field_.at(point + way * way_object_);
    if (!(distance >= -max_drag_) && !(distance >= atRest() - max_drag_))  // too deep, or not a number
      return atRest() - distance;
    if (way == end)
      break;
    way = std::min(way + std::max(distance + max_drag_, MIN_STEP), end);
  }
  return 0;
}

HeldPart::Neighbour::Neighbour(const HeldPart& part, const SurfaceBlocks& other, const Pose& T_camera_other)
    : surface(other),
      T_object_other(part.T_object_camera_ * Eigen::Isometry3f(T_camera_other.cast<float>())),
      to_points(part.of_points_.columns.seenFrom(T_object_other)),
      to_spheres(part.of_spheres_.columns.seenFrom(T_object_other))
{}

Encounter HeldPart::meet(const SurfaceBlocks& other, const Pose& T_camera_other, int index) const
{
  const Neighbour neighbour(*this, other, T_camera_other);
  const std::vector<SurfaceBlocks::Block>& blocks = other.blocks();
  for (std::size_t first = 0; first < blocks.size(); first += BLOCK)
  {
    const auto [x, y, z] = other.middles(first);
    const unsigned near = of_spheres_.columns.meetOnWay(neighbour.to_spheres, x, y, z, of_spheres_.distance, length_);
    const std::size_t end = std::min<std::size_t>(first + BLOCK, blocks.size());
    for (std::size_t b = first; b < end; ++b)
      if ((near >> (b - first) & 1) != 0 || blocks[b].around.radius > LARGE)
        if (const std::optional<Caught> caught = meetBlock(neighbour, blocks[b]))
          return encounter(caught->deepening, ObstacleKind::Part, index,
                           T_camera_other.cast<float>() * other.point(caught->point));
  }
  return {};
}

std::optional<HeldPart::Caught> HeldPart::meetBlock(const Neighbour& other, const SurfaceBlocks::Block& block) const
{
  if (staysOutside({other.T_object_other * block.around.center, block.around.radius}))
    return std::nullopt;
  for (std::size_t first = block.begin; first < block.end; first += BLOCK)
  {
    const auto [x, y, z] = other.surface.coordinates(first);
    const unsigned near = of_points_.columns.meetOnWay(other.to_points, x, y, z, of_points_.distance, length_);
    for (std::size_t k = first; near >> (k - first) != 0; ++k)
      if ((near >> (k - first) & 1) != 0)
        if (const float deeper = deepening(other.T_object_other * other.surface.point(k)); deeper != 0)
          return Caught{deeper, k};
  }
  return std::nullopt;
}

Encounter HeldPart::meetSide(const ConvexBody& side, ObstacleKind kind, int index) const
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
  float at_rest = 0;
  float on_the_way = -max_drag_;
  Eigen::Vector3f contact;
  surface_.deepest(toObject(swept(side, -motion_camera_)), on_the_way, contact);
  if (on_the_way == -max_drag_)
    return {};
  Eigen::Vector3f ignored;
  surface_.deepest(toObject(side), at_rest, ignored);
  const float deeper = at_rest - on_the_way;
  return deeper > max_drag_ ? encounter(deeper, kind, index, T_object_camera_.inverse() * contact) : Encounter{};
}

HeldPart::AmongPoints::AmongPoints(const HeldPart& part, float own)
    : part_(part), own_(own), view_(part.of_points_.columns.seenFrom(part.T_object_camera_))
{}

bool HeldPart::AmongPoints::mayMeet(const Sphere& points_camera) const
{
  return met_.free() && part_.mayMeetInObject({part_.T_object_camera_ * points_camera.center, points_camera.radius});
}

unsigned HeldPart::AmongPoints::mayMeet(const Eigen::Vector3f& ray, float step, const float* depth) const
{
  const Near& near = part_.of_points_;
  return near.columns.meetOnWay(view_, ray, step, depth, near.distance, part_.length_);
}

void HeldPart::AmongPoints::meet(const Eigen::Vector3f& point_camera)
{
  const Eigen::Vector3f point = part_.T_object_camera_ * point_camera;
  if (!met_.free() || std::abs(part_.field_.at(point)) <= own_)
    return;
  if (const float deeper = part_.deepening(point); deeper != 0)
    met_ = part_.encounter(deeper, ObstacleKind::Surface, -1, point_camera);
}
}  // namespace bin_picking
