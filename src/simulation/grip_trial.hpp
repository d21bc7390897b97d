// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/grasping/gripper.hpp"
#include "collision_mesh.hpp"
#include "virtual_cell.hpp"

namespace bin_picking::simulation
{
/// What a grip may do to the parts and still count as clean.
struct GripTrialParameters
{
  double max_push = 0.005;
  double max_width_error = 0.003;
  double friction = 0.4;
  double contact_depth = 0.001;
  double max_drag = 0.001;
  double bin_play = 0.0005;
  double closing_step = 0.00025;
  double retreat_step = 0.001;
  double seal_gap = 0.002;
  double seal_angle = 0.26;

  void visit(ParameterVisitor& v);
};

/// A way to a part and out again: straight translations of one attitude of the flange (tool0: Z out of the flange).
struct GripPath
{
  Pose T_bin_tool0_pre_grasp = Pose::Identity();
  Pose T_bin_tool0_grasp = Pose::Identity();
  Pose T_bin_tool0_retreat = Pose::Identity();
  double opening = 0;  ///< of the fingers on the way in, metres; suction: 0
  double width = 0;    ///< at which they are meant to hold, metres; suction: 0
};

enum class GripStage
{
  Approach,
  Closing,
  Retreat
};

/// What was in the way.
enum class GripObstacle
{
  None,
  Bin,     ///< floor, wall with its rim, table
  Target,  ///< the part that was to be held, touched where it must not be
  Part     ///< another part
};

struct GripVerdict
{
  enum class Outcome
  {
    Taken,
    Missed,    ///< nothing was hit, but nothing is held either, or not as it was meant
    Collision  ///< something was touched that must not be
  };
  Outcome outcome = Outcome::Missed;
  std::string what;  ///< one sentence: which body touched what, where on the way
  int id = -1;       ///< of the part that is held, or that was to be; -1: none
  double final_opening = 0;
  double offset = 0;  ///< how far closing moved the part along Y of the tip, metres

  // Of a collision.
  GripStage stage = GripStage::Approach;
  GripObstacle obstacle = GripObstacle::None;
  std::string body;           ///< of the gripper, or HELD_PART
  std::string obstacle_name;  ///< "wall at +x", "part 3 (three_way_tube)"
  double depth = 0;           ///< how deep they would reach into each other on the whole way, metres; at most 0.02
};

const char* toString(GripVerdict::Outcome outcome);
const char* toString(GripStage stage);
const char* toString(GripObstacle obstacle);

/// Tells by the true geometry what becomes of a grip: the polytopes of the gripper against the triangles of the parts
/// and the bin. It shares nothing with what plans grasps but the description of the gripper. Nothing moves in it but
/// the gripper and the part that is held.
///
/// 1. Approach, fingers open: whatever is touched, the target too, is a collision. The straight way is tested as a
///    whole, not by steps. Where the pre-grasp lies within the bin, so is the way straight down to it from over the
///    rim.
/// 2. Closing, by steps: touching another part or the bin is a collision, as is touching the target with a body that
///    may not. One finger alone pushes the part along, at most by max_push; both together hold it. The opening has to
///    be the one meant, and most of the touched surface has to lie within the friction cone of the fingers' force, as
///    has the line between both contacts. Suction in its place: the whole lip has to meet the surface of one part.
/// 3. Retreat: nothing but the target may be touched by the gripper; the held part must not reach deeper into the bin
///    than at rest, nor by more than max_drag deeper into other parts, which it would drag along. A retreat that ends
///    with gripper or part within the bin goes on straight up until both are over the rim.
class GripJudge
{
public:
  /// \param table_size edge of the table below the bin, metres; 0: none
  GripJudge(const std::vector<CellPart>& parts, const Bin& bin, double table_size);
  explicit GripJudge(const VirtualCell& cell);
  ~GripJudge();
  GripJudge(GripJudge&&) noexcept;
  GripJudge& operator=(GripJudge&&) noexcept;

  /// Thread-safe.
  /// \param bodies what lies in the bin \param id_meant the part to be held; -1: the first that a pad touches
  /// \throws ParameterError poses that are not rigid or not of one attitude, an opening that the gripper has not or
  ///   that is less than the width, no body with this id, a gripper without bodies or without one that may touch
  GripVerdict tryGrip(const std::vector<Body>& bodies, const Gripper& gripper, const GripPath& path, int id_meant,
                      const GripTrialParameters& parameters) const;

private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

/// The same for one grip; who tries many keeps a GripJudge, which prepares the meshes once.
GripVerdict tryGrip(const VirtualCell& cell, const Gripper& gripper, const GripPath& path, int id_meant,
                    const GripTrialParameters& parameters);
}  // namespace bin_picking::simulation
