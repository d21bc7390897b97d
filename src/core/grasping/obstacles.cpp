// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/obstacles.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "bin_picking_perception/common/error.hpp"
#include "bin_sides.hpp"
#include "body_sweep.hpp"
#include "held_part.hpp"
#include "seen_space.hpp"
#include "surface_blocks.hpp"

namespace bin_picking
{
namespace
{
// Distances from the bin beyond this are not asked for unless more is required, metres.
constexpr double BIN_LOOK_AHEAD = 0.02;

// A distance field is cut at its band: what is farther must not count as near.
constexpr float BAND_SHARE = 0.9f;

/// A comparison with what is not finite is never true: it would find nothing in the way. Also of what does not fit into
/// single precision, in which clouds and parts are compared.
template <typename Matrix>
void requireFinite(const Matrix& values, const std::string& what)
{
  if (!values.template cast<float>().allFinite())
    throw ParameterError(what +
                         " is not finite, so that nothing could be found in its way; give finite numbers, metres.");
}

void requireFinite(const Bin& bin)
{
  requireFinite(bin.T_camera_bin.matrix(), "The pose of the bin");
  requireFinite(bin.inner_size, "The inner size of the bin");
  requireFinite(Eigen::Matrix<double, 1, 1>(bin.wall_thickness), "The wall thickness of the bin");
}

/// Whether one of the body's faces, or of the other's, keeps them apart by the distance.
bool farApart(const ConvexBody& a, const ConvexBody& b, double distance)
{
  return std::any_of(b.planes.begin(), b.planes.end(), [&](const Eigen::Vector4d& plane) {
    return std::all_of(a.vertices.begin(), a.vertices.end(),
                       [&](const Eigen::Vector3d& v) { return plane.head<3>().dot(v) + plane.w() > distance; });
  });
}

/// The points of the surface, and the corners of the mesh, which reach farthest between them.
std::vector<Eigen::Vector3f> surfaceOf(const TrainedModel& model)
{
  std::vector<Eigen::Vector3f> points = model.surface.points;
  points.insert(points.end(), model.mesh.vertices.begin(), model.mesh.vertices.end());
  return points;
}
}  // namespace

struct Obstacles::Impl
{
  struct Part
  {
    PlacedPart placed;
    const SurfaceBlocks* surface = nullptr;
    Eigen::Isometry3f T_camera_object;
    Eigen::AlignedBox3f box_camera;
    /// Of few parts: what others hold down needs no more than those.
    mutable std::once_flag has_pixels;
    mutable OwnPixels pixels;
  };

  ObstacleParameters parameters;
  std::vector<BinSide> sides;  ///< none without a bin
  std::optional<SeenSpace> seen;
  std::map<const TrainedModel*, std::unique_ptr<SurfaceBlocks>> surfaces;
  std::vector<Part> parts;

  void checkTarget(std::size_t index) const
  {
    if (index >= parts.size())
      throw ParameterError("There is no part " + std::to_string(index) +
                           " to be taken: " + std::to_string(parts.size()) + " parts were detected.");
  }

  void preparePart(std::size_t i)
  {
    Part& part = parts[i];
    part.T_camera_object = Eigen::Isometry3f(part.placed.T_camera_object.cast<float>());
    for (const Eigen::Vector3f& corner : cornersOf(part.surface->box(), part.T_camera_object))
      part.box_camera.extend(corner);
  }

  const OwnPixels& pixelsOf(const Part& part) const
  {
    std::call_once(part.has_pixels, [&] {
      const DistanceField& field = part.placed.model->field;
      const float tolerance = std::min(static_cast<float>(parameters.target_tolerance), BAND_SHARE * field.band());
      part.pixels = seen->ownPixels(field, part.surface->box(), part.placed.T_camera_object, tolerance);
    });
    return part.pixels;
  }

  void meetBin(const BodySweep& body, Encounter& worst) const
  {
    const double look_ahead = std::max(BIN_LOOK_AHEAD, parameters.bin_clearance);
    for (std::size_t i = 0; i < sides.size(); ++i)
    {
      const BinSide& side = sides[i];
      if (farApart(body.shape, side.box, look_ahead))
        continue;
      keepWorse(worst, {static_cast<float>(bin_picking::clearance(body.shape, side.box)),
                        static_cast<float>(parameters.bin_clearance),
                        side.floor ? ObstacleKind::BinFloor : ObstacleKind::BinWall, static_cast<int>(i)});
    }
  }

  void meetPart(const BodySweep& body, std::size_t index, bool is_target, Encounter& worst) const
  {
    const Part& part = parts[index];
    const Eigen::Vector3f around = Eigen::Vector3f::Constant(LOOK_AHEAD);
    if (!part.box_camera.intersects(Eigen::AlignedBox3f(body.box.min() - around, body.box.max() + around)))
      return;
    Encounter met;
    met.distance = LOOK_AHEAD;
    part.surface->deepest(inFrame(body.planes, part.T_camera_object), met.distance, met.contact);
    if (met.distance >= LOOK_AHEAD)
      return;
    met.required = static_cast<float>(is_target ? parameters.target_clearance : parameters.part_clearance);
    met.kind = is_target ? ObstacleKind::Target : ObstacleKind::Part;
    met.index = static_cast<int>(index);
    met.contact = part.T_camera_object * met.contact;
    keepWorse(worst, met);
  }

  Encounter meet(const BodySweep& body, std::size_t target, bool target_counts) const
  {
    Encounter worst;
    meetBin(body, worst);
    if (target_counts)
      meetPart(body, target, true, worst);
    if (!worst.free())
      return worst;
    if (seen)
      keepWorse(worst, seen->nearest(body, pixelsOf(parts[target])));
    for (std::size_t i = 0; i < parts.size() && worst.free(); ++i)
      if (i != target)
        meetPart(body, i, false, worst);
    return worst;
  }

  /// Those that reach into a box, first what lies farthest in a direction: where a part is pulled that way, it is what
  /// lies on it.
  std::vector<std::size_t> neighboursOf(std::size_t target, const Eigen::AlignedBox3f& box,
                                        const Eigen::Vector3d& direction) const
  {
    std::vector<std::size_t> neighbours;
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (i != target && parts[i].box_camera.intersects(box))
        neighbours.push_back(i);
    const auto reach = [&](std::size_t i) { return parts[i].box_camera.center().cast<double>().dot(direction); };
    std::stable_sort(neighbours.begin(), neighbours.end(),
                     [&](std::size_t a, std::size_t b) { return reach(a) > reach(b); });
    return neighbours;
  }

  Encounter meetHeld(const Eigen::Vector3d& motion_camera, std::size_t target) const
  {
    const Part& held = parts[target];
    const TrainedModel& model = *held.placed.model;
    const HeldPart way(model.field, *held.surface, static_cast<float>(model.parameters.surface_spacing),
                       held.placed.T_camera_object, motion_camera, static_cast<float>(parameters.max_drag));
    Encounter worst;
    for (std::size_t i = 0; i < sides.size(); ++i)
      way.meetSide(sides[i].box, sides[i].floor ? ObstacleKind::BinFloor : ObstacleKind::BinWall, static_cast<int>(i),
                   worst);
    for (const std::size_t i : neighboursOf(target, way.box(), motion_camera))
      if (worst.free())
        way.meet(*parts[i].surface, parts[i].placed.T_camera_object, static_cast<int>(i), worst);
    if (seen && worst.free())
    {
      const OwnPixels& own = pixelsOf(held);
      seen->forEachPoint(way.corners(), [&](int u, int v, const Eigen::Vector3f& point) {
        if (way.box().contains(point) && !own.at(u, v))
          way.meet(point, ObstacleKind::Surface, -1, worst);
      });
    }
    return worst;
  }

  std::string nameOf(const Encounter& met) const
  {
    switch (met.kind)
    {
      case ObstacleKind::None:
        return "";
      case ObstacleKind::BinFloor:
      case ObstacleKind::BinWall:
        return sides[static_cast<std::size_t>(met.index)].name;
      case ObstacleKind::Surface:
        return "measured surface";
      case ObstacleKind::Unknown:
        return "unseen space";
      case ObstacleKind::Part:
      case ObstacleKind::Target:
        break;
    }
    return "part " + std::to_string(met.index) + " (" + parts[static_cast<std::size_t>(met.index)].placed.model->name +
           ")";
  }

  Clearance inWords(const Encounter& met, const std::string& body) const
  {
    Clearance clearance;
    if (met.kind == ObstacleKind::None)
      return clearance;
    clearance.distance = static_cast<double>(met.distance);
    clearance.required = static_cast<double>(met.required);
    clearance.kind = met.kind;
    clearance.body = body;
    clearance.obstacle = nameOf(met);
    if (met.kind == ObstacleKind::Part || met.kind == ObstacleKind::Target)
      clearance.part = met.index;
    clearance.contact_camera = met.contact.cast<double>();
    return clearance;
  }

  /// The worst of all pieces, up to the first that comes too near.
  Clearance sweep(const ToolShape& tool, const Pose& T_camera_tool0, const Eigen::Vector3d& motion_camera,
                  std::size_t target, bool target_counts) const
  {
    checkTarget(target);
    requireFinite(T_camera_tool0.matrix(), "The pose of tool0");
    requireFinite(motion_camera, "The motion of tool0");
    Encounter worst;
    const ToolPiece* of = nullptr;
    for (const ToolPiece& piece : tool)
    {
      const BodySweep body(swept(transformed(piece.shape, T_camera_tool0), motion_camera));
      const Encounter met = meet(body, target, target_counts && !piece.may_touch_target);
      if (!(met.margin() >= worst.margin()))
      {
        worst = met;
        of = &piece;
      }
      if (!worst.free())
        break;
    }
    return inWords(worst, of ? of->body : "");
  }
};

Obstacles::Obstacles(const DepthGrid* measured, const Bin* bin, std::vector<PlacedPart> parts,
                     const ObstacleParameters& parameters, const Executor& executor)
{
  checkRanges(parameters);
  auto impl = std::make_unique<Impl>();
  impl->parameters = parameters;
  if (bin)
  {
    requireFinite(*bin);
    impl->sides = binSides(*bin);
  }
  impl->parts = std::vector<Impl::Part>(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i)
  {
    if (!parts[i].model)
      throw ParameterError("A part is given without its model; the collision check needs its surface.");
    requireFinite(parts[i].T_camera_object.matrix(), "The pose of a part, " + parts[i].model->name + ",");
    impl->surfaces.emplace(parts[i].model, nullptr);
    impl->parts[i].placed = parts[i];
  }
  std::vector<const TrainedModel*> models;
  for (const auto& [model, surface] : impl->surfaces)
    models.push_back(model);
  executor.forEach(models.size() + 1, [&](std::size_t i) {
    if (i > 0)
      impl->surfaces.at(models[i - 1]) = std::make_unique<SurfaceBlocks>(surfaceOf(*models[i - 1]));
    else if (measured)
      impl->seen.emplace(*measured, bin, parameters);
  });
  for (Impl::Part& part : impl->parts)
    part.surface = impl->surfaces.at(part.placed.model).get();
  for (std::size_t i = 0; i < impl->parts.size(); ++i)
    impl->preparePart(i);
  if (impl->seen)
    executor.forEach(SeenSpace::STEPS, [&](std::size_t i) { impl->seen->prepare(i); });
  impl_ = std::move(impl);
}

Obstacles::~Obstacles() = default;
Obstacles::Obstacles(Obstacles&&) noexcept = default;
Obstacles& Obstacles::operator=(Obstacles&&) noexcept = default;

Clearance Obstacles::approach(const ToolShape& open, const ToolMotion& motion, std::size_t target) const
{
  return impl_->sweep(open, motion.T_camera_tool0, motion.motion_camera, target, true);
}

Clearance Obstacles::closing(const ToolShape& closing, const Pose& T_camera_tool0, std::size_t target) const
{
  return impl_->sweep(closing, T_camera_tool0, Eigen::Vector3d::Zero(), target, true);
}

Clearance Obstacles::leaving(const ToolShape& closed, const ToolMotion& motion, std::size_t target) const
{
  return impl_->sweep(closed, motion.T_camera_tool0, motion.motion_camera, target, false);
}

Clearance Obstacles::approach(const Gripper& gripper, const ToolMotion& motion, std::size_t target) const
{
  return approach(shapeAt(gripper, motion.opening), motion, target);
}

Clearance Obstacles::closing(const Gripper& gripper, const Pose& T_camera_tool0, double from, double to,
                             std::size_t target) const
{
  return closing(closingShape(gripper, from, to), T_camera_tool0, target);
}

Clearance Obstacles::pulledOut(const Eigen::Vector3d& motion_camera, std::size_t target) const
{
  impl_->checkTarget(target);
  requireFinite(motion_camera, "The motion of the held part");
  return impl_->inWords(impl_->meetHeld(motion_camera, target), HELD_PART);
}

Clearance Obstacles::retreat(const Gripper& gripper, const ToolMotion& motion, std::size_t target) const
{
  const Clearance of_gripper = leaving(shapeAt(gripper, motion.opening), motion, target);
  if (!of_gripper.free())
    return of_gripper;
  const Clearance of_part = pulledOut(motion.motion_camera, target);
  return of_part.margin() >= of_gripper.margin() ? of_gripper : of_part;
}
}  // namespace bin_picking
