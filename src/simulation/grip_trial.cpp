// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "grip_trial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/figures.hpp"
#include "bin_picking_perception/grasping/obstacles.hpp"
#include "grip_closing.hpp"
#include "held_part.hpp"

namespace bin_picking::simulation
{
namespace
{
constexpr double TABLE_THICKNESS = 0.01;  // metres
constexpr double MAX_TURN = 1e-3;         // rad, between the attitudes of one path
constexpr double ROUNDING = 1e-9;         // metres, by which an opening that was computed may miss the range

/// A side of the bin, as a mesh.
struct BinSide
{
  std::string name;
  CollisionMesh mesh;
};

std::shared_ptr<const TriangleMesh> boxMesh(const Eigen::Vector3d& low, const Eigen::Vector3d& high)
{
  return std::make_shared<TriangleMesh>(toMesh(makeBox(0.5 * (low + high), high - low)));
}

std::vector<BinSide> makeSides(const Bin& bin, double table_size)
{
  const double t = bin.wall_thickness;
  const Eigen::Vector3d inner(bin.inner_size.x() / 2, bin.inner_size.y() / 2, bin.inner_size.z());
  const Eigen::Vector3d outer = inner + Eigen::Vector3d(t, t, 0);
  std::vector<BinSide> sides;
  const auto add = [&sides](const char* name, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    sides.push_back({name, CollisionMesh(boxMesh(low, high), CollisionMesh::Surface::Left)});
  };
  add("floor", {-outer.x(), -outer.y(), -t}, {outer.x(), outer.y(), 0});
  add("wall at +x", {inner.x(), -outer.y(), 0}, outer);
  add("wall at -x", {-outer.x(), -outer.y(), 0}, {-inner.x(), outer.y(), outer.z()});
  add("wall at +y", {-outer.x(), inner.y(), 0}, outer);
  add("wall at -y", {-outer.x(), -outer.y(), 0}, {outer.x(), -inner.y(), outer.z()});
  if (table_size > 0)
    add("table", {-table_size / 2, -table_size / 2, -t - TABLE_THICKNESS}, {table_size / 2, table_size / 2, -t});
  return sides;
}

void checkRigid(const Pose& pose, const char* name)
{
  const Eigen::Matrix3d r = pose.linear();
  if (!pose.matrix().allFinite() || !(r.transpose() * r).isIdentity(1e-6) || !(r.determinant() > 0))
    throw ParameterError(std::string("the ") + name +
                         " pose of the grip is not a rigid motion of finite numbers; give a rotation and a position");
}

void checkAttitude(const GripPath& path)
{
  for (const Pose* pose : {&path.T_bin_tool0_pre_grasp, &path.T_bin_tool0_retreat})
  {
    const double turn = Eigen::AngleAxisd(pose->linear().transpose() * path.T_bin_tool0_grasp.linear()).angle();
    if (turn > MAX_TURN)
      throw ParameterError(std::string(pose == &path.T_bin_tool0_retreat ? "the retreat" : "the pre-grasp") +
                           " is turned against the grasp by " + std::to_string(turn * 180 / M_PI) +
                           " deg, but the ways are straight translations: give all three poses the same orientation");
  }
}

void checkOpening(const Gripper& gripper, const GripPath& path)
{
  if (gripper.kind == Gripper::Kind::Suction)
    return;
  if (!(path.opening <= gripper.max_opening + ROUNDING && path.opening >= gripper.min_opening - ROUNDING))
    throw ParameterError("the grip asks for an opening of " + millimetres(path.opening) + ", but the gripper '" +
                         gripper.name + "' opens from " + millimetres(gripper.min_opening) + " to " +
                         millimetres(gripper.max_opening));
  if (!(path.width > 0 && path.width < path.opening))
    throw ParameterError("the width of the grip is " + millimetres(path.width) +
                         ", but it must be positive and less than its opening of " + millimetres(path.opening));
}

void check(const Gripper& gripper, const GripPath& path)
{
  checkRigid(path.T_bin_tool0_pre_grasp, "pre-grasp");
  checkRigid(path.T_bin_tool0_grasp, "grasp");
  checkRigid(path.T_bin_tool0_retreat, "retreat");
  checkAttitude(path);
  checkOpening(gripper, path);
  if (std::none_of(gripper.bodies.begin(), gripper.bodies.end(), [](const GripperBody& b) { return b.touches_part; }))
    throw ParameterError("the gripper '" + gripper.name +
                         "' has no body with touches_part, so that nothing could ever be held; mark its pads or lip");
}

double lowestOf(const Gripper& gripper, const Pose& T_bin_tool0, double opening)
{
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < gripper.bodies.size(); ++b)
    for (const Eigen::Vector3d& p : bodyInBin(gripper, b, T_bin_tool0, opening).vertices)
      lowest = std::min(lowest, p.z());
  return lowest;
}

/// One grip, step by step.
class Trial
{
public:
  Trial(GripScene scene, const Gripper& gripper, const GripPath& path, const GripTrialParameters& parameters)
      : scene_(std::move(scene)), gripper_(gripper), path_(path), parameters_(parameters)
  {}

  GripVerdict run()
  {
    const bool is_over = entryCollides() || approachCollides() || !closes() || retreatCollides() || exitCollides();
    if (scene_.target)
      verdict_.id = scene_.meshes[*scene_.target].id;
    if (is_over)
      return verdict_;
    verdict_.outcome = GripVerdict::Outcome::Taken;
    verdict_.what = "Took " + targetName();
    if (gripper_.kind == Gripper::Kind::Fingers)
      verdict_.what += ", held at " + millimetres(verdict_.final_opening) + " and moved by " +
                       millimetres(std::abs(verdict_.offset)) + " into the grip";
    verdict_.what += ".";
    return verdict_;
  }

private:
  bool isPad(std::size_t body) const { return gripper_.bodies[body].touches_part; }
  std::string targetName() const { return scene_.meshes[*scene_.target].name; }

  /// How far up something has to go to be over the rim with its lowest point.
  Eigen::Vector3d lift(double lowest) const { return {0, 0, std::max(0.0, scene_.rim - lowest)}; }

  std::optional<Touch> touchOfOpenGripper(const GripperWay& way) const
  {
    // The lip is pressed on the part, and is soft.
    const bool may_touch = gripper_.kind == Gripper::Kind::Suction;
    return firstTouch(scene_, gripper_, way, [&](std::size_t body, std::size_t mesh) {
      return may_touch && isPad(body) && (scene_.target ? scene_.isTarget(mesh) : scene_.meshes[mesh].isPart());
    });
  }

  /// A way that begins within the bin says nothing of how the gripper got there: straight down from over the rim.
  bool entryCollides()
  {
    const Eigen::Vector3d down = -lift(lowestOf(gripper_, path_.T_bin_tool0_pre_grasp, path_.opening));
    const GripperWay way{Eigen::Translation3d(-down) * path_.T_bin_tool0_pre_grasp, down, path_.opening};
    const auto touch = touchOfOpenGripper(way);
    if (touch)
      collide(
          GripStage::Approach, *touch, way,
          "on the way down into the bin, " + millimetres((1 - touch->time) * down.norm()) + " before the pre-grasp");
    return touch.has_value();
  }

  bool approachCollides()
  {
    const Eigen::Vector3d motion = path_.T_bin_tool0_grasp.translation() - path_.T_bin_tool0_pre_grasp.translation();
    const GripperWay way{path_.T_bin_tool0_pre_grasp, motion, path_.opening};
    const auto touch = touchOfOpenGripper(way);
    if (touch)
      collide(GripStage::Approach, *touch, way,
              "on the approach, " + millimetres((1 - touch->time) * motion.norm()) + " before the grasp");
    return touch.has_value();
  }

  bool closes()
  {
    const bool is_suction = gripper_.kind == Gripper::Kind::Suction;
    const Closing closing =
        is_suction ? seal(scene_, gripper_, path_, parameters_) : closeFingers(scene_, gripper_, path_, parameters_);
    verdict_.final_opening = closing.opening;
    verdict_.offset = closing.shift;
    if (closing.touch)
      collide(GripStage::Closing, *closing.touch, {path_.T_bin_tool0_grasp, Eigen::Vector3d::Zero(), closing.opening},
              "while closing, at an opening of " + millimetres(closing.opening));
    else if (!closing.missed.empty())
    {
      verdict_.outcome = GripVerdict::Outcome::Missed;
      verdict_.stage = GripStage::Closing;
      verdict_.what = closing.missed;
    }
    return !closing.touch && closing.missed.empty();
  }

  Eigen::Vector3d retreat() const
  {
    return path_.T_bin_tool0_retreat.translation() - path_.T_bin_tool0_grasp.translation();
  }

  /// By which closing has moved the part.
  Eigen::Vector3d shift() const
  {
    return verdict_.offset * (path_.T_bin_tool0_grasp.linear() * gripper_.R_tool0_tip.col(1));
  }

  bool retreatCollides()
  {
    return wayOutCollides({path_.T_bin_tool0_grasp, retreat(), verdict_.final_opening}, shift(),
                          "on the retreat, %s after the grasp");
  }

  /// A retreat that ends within the bin does not yet take the part out: straight up to over the rim.
  bool exitCollides()
  {
    const Eigen::Vector3d moved = shift() + retreat();
    const double lowest_of_held = scene_.meshes[*scene_.target].bounds_bin.min().z() + moved.z();
    const double lowest_of_gripper = lowestOf(gripper_, path_.T_bin_tool0_retreat, verdict_.final_opening);
    const Eigen::Vector3d up = lift(std::min(lowest_of_held, lowest_of_gripper));
    return wayOutCollides({path_.T_bin_tool0_retreat, up, verdict_.final_opening}, moved,
                          "on the way up out of the bin, %s after the retreat");
  }

  /// \param moved by which the held part was moved before \param place with %s for the length of the way until then
  bool wayOutCollides(const GripperWay& way, const Eigen::Vector3d& moved, const std::string& place)
  {
    const Eigen::Vector3d& motion = way.motion_bin;
    const auto gripper =
        firstTouch(scene_, gripper_, way, [this](std::size_t, std::size_t mesh) { return scene_.isTarget(mesh); });
    const auto held = firstTouchOfHeld(scene_, moved, motion, parameters_);
    const auto where = [&](double time) {
      return std::string(place).replace(place.find("%s"), 2, millimetres(time * motion.norm()));
    };
    if (gripper && (!held || gripper->time <= held->time))
      collide(GripStage::Retreat, *gripper, way, where(gripper->time));
    else if (held)
      drag(*held, where(held->time));
    return gripper || held;
  }

  void setCollision(GripStage stage, std::size_t mesh, const std::string& body, double depth)
  {
    verdict_.outcome = GripVerdict::Outcome::Collision;
    verdict_.stage = stage;
    verdict_.obstacle = scene_.isTarget(mesh)          ? GripObstacle::Target
                        : scene_.meshes[mesh].isPart() ? GripObstacle::Part
                                                       : GripObstacle::Bin;
    verdict_.obstacle_name = scene_.meshes[mesh].name;
    verdict_.body = body;
    verdict_.depth = depth;
  }

  void collide(GripStage stage, const Touch& touch, const GripperWay& way, const std::string& where)
  {
    const ConvexBody body = bodyInBin(gripper_, touch.body, way.T_bin_tool0, way.opening);
    setCollision(stage, touch.mesh, gripper_.bodies[touch.body].name,
                 depthOnWay(scene_.meshes[touch.mesh], body, way.motion_bin));
    verdict_.what = "The gripper's " + verdict_.body + " touches " +
                    (scene_.isTarget(touch.mesh) ? "the part to be held, " : "") + verdict_.obstacle_name + ", " +
                    where + ", and would reach " + millimetres(verdict_.depth) + " into it.";
  }

  void drag(const HeldTouch& touch, const std::string& where)
  {
    setCollision(GripStage::Retreat, touch.mesh, HELD_PART, touch.depth);
    const std::string held = "The held " + targetName();
    verdict_.what = scene_.meshes[touch.mesh].isPart()
                        ? held + " drags " + verdict_.obstacle_name + " along " + where + ": it reaches " +
                              millimetres(touch.depth) + " deeper into it than at rest, " +
                              millimetres(parameters_.max_drag) + " are allowed (max_drag)."
                        : held + " runs into the " + verdict_.obstacle_name + " " + where + ".";
  }

  GripScene scene_;
  const Gripper& gripper_;
  const GripPath& path_;
  const GripTrialParameters& parameters_;
  GripVerdict verdict_;
};
}  // namespace

struct GripJudge::Impl
{
  std::vector<std::string> names;
  std::vector<CollisionMesh> parts;
  std::vector<BinSide> sides;
  double rim = 0;

  GripScene scene(const std::vector<Body>& bodies, int id_meant) const
  {
    GripScene scene;
    scene.rim = rim;
    for (const BinSide& side : sides)
      scene.meshes.emplace_back(side.mesh, Pose::Identity(), side.name, -1);
    for (const Body& body : bodies)
    {
      const auto kind = static_cast<std::size_t>(body.shape);
      if (body.id == id_meant)
        scene.target = scene.meshes.size();
      scene.meshes.emplace_back(parts.at(kind), body.T_bin_object,
                                "part " + std::to_string(body.id) + " (" + names.at(kind) + ")", body.id);
    }
    if (id_meant >= 0 && !scene.target)
      throw ParameterError("no part in the bin has the id " + std::to_string(id_meant) +
                           "; give that of one that is there, or -1 for whatever is gripped");
    return scene;
  }
};

GripJudge::GripJudge(const std::vector<CellPart>& parts, const Bin& bin, double table_size)
{
  auto impl = std::make_unique<Impl>();
  for (const CellPart& part : parts)
  {
    impl->names.push_back(part.name);
    impl->parts.emplace_back(part.mesh);
  }
  impl->sides = makeSides(bin, table_size);
  impl->rim = bin.inner_size.z();
  impl_ = std::move(impl);
}

GripJudge::GripJudge(const VirtualCell& cell) : GripJudge(cell.parts(), cell.bin(), cell.parameters().layout.table_size)
{}

GripJudge::~GripJudge() = default;
GripJudge::GripJudge(GripJudge&&) noexcept = default;
GripJudge& GripJudge::operator=(GripJudge&&) noexcept = default;

GripVerdict GripJudge::tryGrip(const std::vector<Body>& bodies, const Gripper& gripper, const GripPath& path,
                               int id_meant, const GripTrialParameters& parameters) const
{
  checkRanges(parameters);
  check(gripper, path);
  return Trial(impl_->scene(bodies, id_meant), gripper, path, parameters).run();
}

GripVerdict tryGrip(const VirtualCell& cell, const Gripper& gripper, const GripPath& path, int id_meant,
                    const GripTrialParameters& parameters)
{
  return GripJudge(cell).tryGrip(cell.bodies(), gripper, path, id_meant, parameters);
}
}  // namespace bin_picking::simulation
