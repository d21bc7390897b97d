// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "grip_closing.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "bin_picking_perception/common/figures.hpp"
#include "grip_contact.hpp"

namespace bin_picking::simulation
{
namespace
{
// A pad that does not come free of the part within so much presses on it from another side than the closing direction.
constexpr double MAX_PUSH_OUT = 0.003;  // metres

/// The fingers at one opening.
class Fingers
{
public:
  Fingers(const Gripper& gripper, const Pose& T_bin_tool0) : gripper_(gripper), T_bin_tool0_(T_bin_tool0)
  {
    closing_bin_ = T_bin_tool0.linear() * gripper.R_tool0_tip.col(1);
    for (const GripperBody& body : gripper.bodies)
      is_moving_.push_back(body.placements.size() > 1);
  }

  void moveTo(double opening)
  {
    bodies_.clear();
    for (std::size_t b = 0; b < gripper_.bodies.size(); ++b)
      bodies_.push_back(bodyInBin(gripper_, b, T_bin_tool0_, opening));
    middle_ = closing_bin_.dot((T_bin_tool0_ * gripper_.T_tool0_tip(opening)).translation());
  }

  std::size_t size() const { return bodies_.size(); }
  const ConvexBody& body(std::size_t b) const { return bodies_[b]; }
  bool isMoving(std::size_t b) const { return is_moving_[b]; }
  bool isPad(std::size_t b) const { return gripper_.bodies[b].touches_part; }
  const Eigen::Vector3d& closing() const { return closing_bin_; }  ///< unit, bin frame
  /// On which side of the tip's middle a body is: +1 or -1.
  double side(std::size_t b) const
  {
    double sum = 0;
    for (const Eigen::Vector3d& p : bodies_[b].vertices)
      sum += closing_bin_.dot(p) - middle_;
    return sum < 0 ? -1 : 1;
  }

private:
  const Gripper& gripper_;
  Pose T_bin_tool0_;
  Eigen::Vector3d closing_bin_;
  std::vector<bool> is_moving_;
  std::vector<ConvexBody> bodies_;
  double middle_ = 0;
};

bool overlaps(const PlacedMesh& placed, const ConvexBody& body_bin, const Eigen::Vector3d& shift_bin)
{
  const ConvexBody seen = moved(body_bin, -shift_bin);  // as if the part had stayed
  if (!placed.bounds_bin.intersects(boundsOf(seen)))
    return false;
  return firstOverlap(*placed.mesh, transformed(seen, placed.T_mesh_bin), Eigen::Vector3d::Zero()).has_value();
}

/// How far the body has to move along `away` (unit) until it is free of the mesh: through all overlaps that follow one
/// another without a gap.
double pushOut(const PlacedMesh& placed, const ConvexBody& body_bin, const Eigen::Vector3d& away_bin)
{
  if (!placed.bounds_bin.intersects(boundsOf(body_bin)))
    return 0;
  const ConvexBody body = transformed(body_bin, placed.T_mesh_bin);
  const Eigen::Vector3d away = placed.T_mesh_bin.linear() * away_bin;
  std::vector<TimeSpan> spans;
  placed.mesh->tree().visit(boundsOf(body, MAX_PUSH_OUT * away), [&](std::size_t k) {
    const TimeSpan span = overlapTimes(body, away, placed.mesh->triangles()[k], {0, MAX_PUSH_OUT});
    if (!span.empty())
      spans.push_back(span);
  });
  std::sort(spans.begin(), spans.end(), [](const TimeSpan& a, const TimeSpan& b) { return a.begin < b.begin; });
  double free_from = 0;
  for (const TimeSpan& span : spans)
    if (span.begin <= free_from)
      free_from = std::max(free_from, span.end);
  return free_from;
}

/// The scene's parts and bin but for the target: a finger must not touch them on its way inwards.
std::optional<Touch> touchOfOthers(GripScene& scene, const Fingers& fingers)
{
  for (std::size_t b = 0; b < fingers.size(); ++b)
    for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    {
      if (!fingers.isMoving(b) || scene.isTarget(m) ||
          !overlaps(scene.meshes[m], fingers.body(b), Eigen::Vector3d::Zero()))
        continue;
      if (!scene.target && fingers.isPad(b) && scene.meshes[m].isPart())
        scene.target = m;
      else
        return Touch{0, b, m};
    }
  return std::nullopt;
}

/// How far the pads of one side reach into the target, which lies shifted.
double pressOf(const Fingers& fingers, double side, const PlacedMesh& target, double shift)
{
  double press = 0;
  for (std::size_t b = 0; b < fingers.size(); ++b)
    if (fingers.isPad(b) && fingers.side(b) == side)
      press = std::max(press,
                       pushOut(target, moved(fingers.body(b), -shift * fingers.closing()), side * fingers.closing()));
  return press;
}

/// What the fingers at this opening do to the target. \return true: both press it
bool pressTarget(const Fingers& fingers, const GripScene& scene, Closing& closing)
{
  const PlacedMesh& target = scene.meshes[*scene.target];
  const double right = pressOf(fingers, 1, target, closing.shift);
  const double left = pressOf(fingers, -1, target, closing.shift);
  if (right > 0 && left > 0)
    return true;
  if (right == 0 && left == 0)
    return false;
  closing.shift += left - right;
  return pressOf(fingers, right > 0 ? -1 : 1, target, closing.shift) > 0;
}

/// A body that must not touch the target, or a pad that comes down on it instead of from its side.
std::optional<Touch> badTouchOfTarget(const Fingers& fingers, const GripScene& scene, const Closing& closing)
{
  const PlacedMesh& target = scene.meshes[*scene.target];
  const Eigen::Vector3d shift_bin = closing.shift * fingers.closing();
  for (std::size_t b = 0; b < fingers.size(); ++b)
    if (fingers.isPad(b) ? pressOf(fingers, fingers.side(b), target, closing.shift) >= MAX_PUSH_OUT
                         : overlaps(target, fingers.body(b), shift_bin))
      return Touch{0, b, *scene.target};
  return std::nullopt;
}

std::string pushedTooFar(const PlacedMesh& target, double shift, const GripTrialParameters& parameters)
{
  return "One finger alone pushes " + target.name + " by more than " + millimetres(parameters.max_push) + " (" +
         millimetres(std::abs(shift)) + ") before the other one touches it (max_push).";
}

std::string closedOnNothing(const GripScene& scene, double opening, double width)
{
  return "The fingers closed to " + millimetres(opening) + " and do not hold " +
         (scene.target ? scene.meshes[*scene.target].name : "anything") + "; the grip was meant to hold at " +
         millimetres(width) + ".";
}

/// Whether what both fingers press is a hold; a sentence if not.
std::string judgeHold(const Fingers& fingers, const GripScene& scene, const Closing& closing, double width,
                      const GripTrialParameters& parameters)
{
  const PlacedMesh& target = scene.meshes[*scene.target];
  if (std::abs(closing.opening - width) > parameters.max_width_error)
    return "The fingers stop on " + target.name + " at " + millimetres(closing.opening) + " instead of " +
           millimetres(width) + ", " + millimetres(parameters.max_width_error) + " are allowed (max_width_error).";
  std::array<ContactPatch, 2> patches;
  for (std::size_t b = 0; b < fingers.size(); ++b)
    if (fingers.isPad(b))
    {
      const Eigen::Vector3d outwards = fingers.side(b) * fingers.closing();
      const ConvexBody pad = moved(fingers.body(b), -closing.shift * fingers.closing());
      addContact(patches[fingers.side(b) > 0], target, pad, outwards, parameters);
    }
  return judgeContacts(patches[1], patches[0], target, fingers.closing(), parameters);
}
}  // namespace

Closing closeFingers(GripScene& scene, const Gripper& gripper, const GripPath& path,
                     const GripTrialParameters& parameters)
{
  Fingers fingers(gripper, path.T_bin_tool0_grasp);
  Closing closing;
  const double end = std::max(gripper.min_opening, path.width - parameters.max_width_error);
  const int steps = std::max(1, static_cast<int>(std::ceil((path.opening - end) / parameters.closing_step)));
  for (int k = 1; k <= steps; ++k)
  {
    closing.opening = path.opening + (end - path.opening) * k / steps;
    fingers.moveTo(closing.opening);
    closing.touch = touchOfOthers(scene, fingers);
    if (closing.touch)
      return closing;
    if (!scene.target)
      continue;
    closing.touch = badTouchOfTarget(fingers, scene, closing);
    if (closing.touch)
      return closing;
    const bool is_held = pressTarget(fingers, scene, closing);
    if (std::abs(closing.shift) > parameters.max_push)
      closing.missed = pushedTooFar(scene.meshes[*scene.target], closing.shift, parameters);
    else if (is_held)
      closing.missed = judgeHold(fingers, scene, closing, path.width, parameters);
    if (is_held || !closing.missed.empty())
      return closing;
  }
  closing.missed = closedOnNothing(scene, closing.opening, path.width);
  return closing;
}
}  // namespace bin_picking::simulation
