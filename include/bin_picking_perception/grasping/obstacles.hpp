// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/grasping/gripper.hpp"
#include "bin_picking_perception/grasping/tool_shape.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "bin_picking_perception/scene/bin.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
/// How near the gripper and the held part may come to what.
struct ObstacleParameters
{
  double bin_clearance = 0.003;
  // Chosen by emptying bins (benchmark/picking): with these no grasp that is called free touches anything, and larger
  // ones leave parts behind.
  double surface_clearance = 0.001;
  double part_clearance = 0.001;
  double target_clearance = 0.0015;
  double unseen_entry = 0.008;
  double shadow_entry = 0.012;
  double unknown_entry = 0.002;
  double target_tolerance = 0.003;
  double max_drag = 0.0005;

  void visit(ParameterVisitor& v);
};

enum class ObstacleKind
{
  None,
  BinFloor,
  BinWall,  ///< rim included
  Surface,  ///< measured, of no detected part
  Unknown,  ///< behind what was measured, or where nothing was
  Part,     ///< another detection
  Target    ///< the part to be taken
};

/// "none", "bin_floor", ... for logs and messages.
const char* toString(ObstacleKind kind);

/// What Clearance::body names where it is no body of the gripper.
constexpr char HELD_PART[] = "held part";

/// The obstacle that decides: the one whose distance falls short of what is required the most, or exceeds it the least.
struct Clearance
{
  /// Signed, metres; < 0: how deep the body reaches in. Apart, a lower bound, exact where a face is nearest; infinite
  /// where nothing is near (5 mm more than bin_clearance for the bin; 4 mm for the rest). Of unseen space:
  /// what is left of the entry allowed, or exceeds it. Of the held part, which touches what it lies on as a rule:
  /// infinite where it comes out; else how much deeper than at rest it gets into the first that holds it, negative:
  /// more than that is only a bound.
  double distance = std::numeric_limits<double>::infinity();
  double required = 0;  ///< of that kind of obstacle, metres
  ObstacleKind kind = ObstacleKind::None;
  std::string body;      ///< of the gripper, or HELD_PART
  std::string obstacle;  ///< "wall at +x", "part 3 (three_way_tube)", "measured surface", "unseen space", ...
  int part = -1;         ///< index of the detection where kind is Part or Target
  /// Where it is nearest, or deepest; NaN where that is not one point.
  Eigen::Vector3d contact_camera = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());

  bool free() const { return distance >= required; }
  double margin() const { return distance - required; }
};

/// A detected part; the model must outlive the obstacles.
struct PlacedPart
{
  const TrainedModel* model = nullptr;
  Pose T_camera_object = Pose::Identity();
};

/// A straight motion of the flange with a fixed finger distance.
struct ToolMotion
{
  Pose T_camera_tool0 = Pose::Identity();                   ///< at its start
  Eigen::Vector3d motion_camera = Eigen::Vector3d::Zero();  ///< metres
  double opening = 0;                                       ///< metres
};

/// Everything that a gripper may touch, made once per cloud; then read by many threads.
///
/// - The bin: five solid boxes, against exact convex sweeps.
/// - Detected parts: the points of their trained surface (hidden sides too) against exact convex sweeps.
/// - The measured cloud: each measured point, and for each pixel's ray the space behind it. What no ray has passed is
///   not free: a body may enter it by `unseen_entry` only, by `shadow_entry` where the target itself hides it, and by
///   `unknown_entry` where neither a detected part nor the bin does: of what does, nobody knows the far side.
/// - Pixels without a measurement are bridged by a straight line between the measured points left and right, and above
///   and below, whichever is nearer to the camera; nothing behind that sheet is free. Beyond the picture the inside of
///   the bin is unknown, and what a wall hides of it; the rest is free. That holds for rays up to two sizes of the
///   picture beside it; farther out, and anywhere beside it without a bin, nothing is checked.
///
/// What is not finite is never free: such a pose, motion, opening or bin is refused.
///
/// A check stops at the first kind of obstacle to which a body comes too near: the bin, the target, other parts, the
/// cloud. The clearance names the worst of that kind.
class Obstacles
{
public:
  /// \param measured the reduced grid, floor and walls included (DetectionResult::surroundings); read only here.
  ///   nullptr: no cloud check
  /// \param bin nullptr: none
  /// \param parts all accepted detections, in their order; the target is one of them
  /// \throws ParameterError a parameter out of its range, a part without model, a pose or a bin that is not finite
  Obstacles(const DepthGrid* measured, const Bin* bin, std::vector<PlacedPart> parts,
            const ObstacleParameters& parameters, const Executor& executor);
  ~Obstacles();
  Obstacles(Obstacles&&) noexcept;
  Obstacles& operator=(Obstacles&&) noexcept;

  // All throw ParameterError for a target that is no part, a gripper without bodies, an opening that it does not have,
  // and a pose or a motion that is not finite.

  /// The way in, all bodies at the motion's opening, against everything; the target too, but for the lip of a suction
  /// gripper, which is pressed on it. \param target index of the part to be taken
  Clearance approach(const Gripper& gripper, const ToolMotion& motion, std::size_t target) const;

  /// The fingers move from one opening to another, the flange rests. Bodies that touch the part may touch the target.
  Clearance closing(const Gripper& gripper, const Pose& T_camera_tool0, double from, double to,
                    std::size_t target) const;

  /// The way out: the gripper at the motion's opening, and the target held: leaving(), then pulledOut().
  Clearance retreat(const Gripper& gripper, const ToolMotion& motion, std::size_t target) const;

  // The same with shapes that were made once for many ways; `motion.opening` is not looked at.

  Clearance approach(const ToolShape& open, const ToolMotion& motion, std::size_t target) const;
  Clearance closing(const ToolShape& closing, const Pose& T_camera_tool0, std::size_t target) const;
  /// The gripper alone on the way out.
  Clearance leaving(const ToolShape& closed, const ToolMotion& motion, std::size_t target) const;

  /// The target alone on the way out. It may touch what it touches at rest, but go no deeper into it than `max_drag`:
  /// the clearance names the first thing that holds it, or none. The same for all grasps that retreat by the same
  /// motion (metres).
  Clearance pulledOut(const Eigen::Vector3d& motion_camera, std::size_t target) const;

private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};
}  // namespace bin_picking
