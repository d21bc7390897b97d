// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/obstacles.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "bin_picking_perception/common/error.hpp"
#include "bin_sides.hpp"
#include "body_sweep.hpp"
#include "held_part.hpp"
#include "own_pixels.hpp"
#include "seen_space.hpp"
#include "surface_blocks.hpp"
#include "tool_way.hpp"

namespace bin_picking
{
namespace
{
// Distances from the bin that are so much more than required are not asked for, metres; the ranking asks for less.
constexpr double BIN_LOOK_AHEAD = 0.005;

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

/// Around points on a straight way, in the frame to which T leads; the points are Eigen vectors.
template <typename Points>
Eigen::AlignedBox3d boxAround(const Points& points, const Pose& T, const Eigen::Vector3d& motion)
{
  Eigen::AlignedBox3d box;
  for (const auto& point : points)
    box.extend(Eigen::Vector3d(T * point.template cast<double>()));
  return box.extend(Eigen::AlignedBox3d(box.min() + motion, box.max() + motion));
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
  };

  ObstacleParameters parameters;
  Pose T_bin_camera = Pose::Identity();  ///< with a bin
  std::vector<BinSide> sides;            ///< none without a bin
  std::optional<SeenSpace> seen;
  std::map<const TrainedModel*, std::unique_ptr<SurfaceBlocks>> surfaces;
  std::vector<Part> parts;
  std::vector<OwnPixels> pixels;  ///< of the parts, with a cloud

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
    if (!seen)
      return;
    const DistanceField& field = part.placed.model->field;
    const float tolerance = std::min(static_cast<float>(parameters.target_tolerance), BAND_SHARE * field.band());
    pixels.emplace_back(*seen, field, part.surface->box(), part.placed.T_camera_object, tolerance);
  }

  /// Distances from the bin beyond this are not asked for, metres.
  double binLookAhead() const { return parameters.bin_clearance + BIN_LOOK_AHEAD; }

  static ObstacleKind kindOf(const BinSide& side)
  {
    return side.floor ? ObstacleKind::BinFloor : ObstacleKind::BinWall;
  }

  Encounter meetBin(ToolWay& way, std::size_t piece) const
  {
    const Eigen::AlignedBox3d covered = boxAround(way.piece(piece).shape.vertices, T_bin_camera * way.T_camera_tool0(),
                                                  T_bin_camera.linear() * way.motion_camera());
    Encounter worst;
    for (std::size_t i = 0; i < sides.size(); ++i)
    {
      const BinSide& side = sides[i];
      if (areApart(covered, side.box_bin, binLookAhead()))
        continue;
      keepWorse(worst, {static_cast<float>(bin_picking::clearance(way.covered(piece).shape, side.box)),
                        static_cast<float>(parameters.bin_clearance), kindOf(side), static_cast<int>(i)});
    }
    return worst;
  }

  /// \param scratch for the body's planes in the part's frame
  Encounter meetPart(const BodySweep& body, std::size_t index, bool is_target, Planes& scratch) const
  {
    Encounter met;
    const Part& part = parts[index];
    const Eigen::Vector3f around = Eigen::Vector3f::Constant(LOOK_AHEAD);
    if (!part.box_camera.intersects(Eigen::AlignedBox3f(body.box.min() - around, body.box.max() + around)))
      return met;
    float distance = LOOK_AHEAD;
    toFrame(part.T_camera_object, body.planes, scratch);
    part.surface->deepest(scratch, distance, met.contact);
    if (distance >= LOOK_AHEAD)
      return met;
    met.distance = distance;
    met.required = static_cast<float>(is_target ? parameters.target_clearance : parameters.part_clearance);
    met.kind = is_target ? ObstacleKind::Target : ObstacleKind::Part;
    met.index = static_cast<int>(index);
    met.contact = part.T_camera_object * met.contact;
    return met;
  }

  Encounter meetOthers(const BodySweep& body, std::size_t target, Planes& scratch) const
  {
    Encounter worst;
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (i != target)
        keepWorse(worst, meetPart(body, i, false, scratch));
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
    const auto spacing = static_cast<float>(model.parameters.surface_spacing);
    const HeldPart way(model.field, *held.surface, spacing, held.placed.T_camera_object, motion_camera,
                       static_cast<float>(parameters.max_drag));
    const Eigen::AlignedBox3d covered = boxAround(way.corners(), T_bin_camera, Eigen::Vector3d::Zero());
    for (std::size_t i = 0; i < sides.size(); ++i)
      if (!areApart(covered, sides[i].box_bin, 0))
        if (Encounter met = way.meetSide(sides[i].box, kindOf(sides[i]), static_cast<int>(i)); !met.free())
          return met;
    for (const std::size_t i : neighboursOf(target, way.box(), motion_camera))
      if (Encounter met = way.meet(*parts[i].surface, parts[i].placed.T_camera_object, static_cast<int>(i));
          !met.free())
        return met;
    if (!seen)
      return {};
    HeldPart::AmongPoints among(way, pixels[target].tolerance());
    seen->forEachPoint(way.corners(), among);
    return among.met();
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

  /// Up to the first kind of obstacle to which a piece comes too near: what takes less time first, and parts before the
  /// cloud that shows them, because they tell more.
  void meetAll(ToolWay& way, std::size_t target, bool target_counts) const
  {
    Planes scratch;
    if (!way.meet([&](std::size_t i) { return meetBin(way, i); }))
      return;
    if (target_counts && !way.meet([&](std::size_t i) {
          return way.piece(i).may_touch_target ? Encounter{} : meetPart(way.covered(i), target, true, scratch);
        }))
      return;
    if (!way.meet([&](std::size_t i) { return meetOthers(way.covered(i), target, scratch); }))
      return;
    if (!seen)
      return;
    const PixelOwners owners(*seen, pixels, target, sides, T_bin_camera,
                             static_cast<float>(parameters.target_tolerance));
    way.meet([&](std::size_t i) { return seen->nearest(way.covered(i), owners); });
  }

  Clearance sweep(const ToolShape& tool, const Pose& T_camera_tool0, const Eigen::Vector3d& motion_camera,
                  std::size_t target, bool target_counts) const
  {
    checkTarget(target);
    requireFinite(T_camera_tool0.matrix(), "The pose of tool0");
    requireFinite(motion_camera, "The motion of tool0");
    ToolWay way(tool, T_camera_tool0, motion_camera);
    meetAll(way, target, target_counts);
    return inWords(way.worst(), way.body());
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
    impl->T_bin_camera = bin->T_camera_bin.inverse();
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
      impl->seen.emplace(*measured, bin, parameters, executor);
  });
  for (std::size_t i = 0; i < impl->parts.size(); ++i)
  {
    impl->parts[i].surface = impl->surfaces.at(impl->parts[i].placed.model).get();
    impl->preparePart(i);
  }
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
  Clearance of_gripper = leaving(shapeAt(gripper, motion.opening), motion, target);
  if (!of_gripper.free())
    return of_gripper;
  Clearance of_part = pulledOut(motion.motion_camera, target);
  return of_part.margin() >= of_gripper.margin() ? of_gripper : of_part;
}
}  // namespace bin_picking
