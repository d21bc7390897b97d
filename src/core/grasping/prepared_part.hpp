// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/grasping/grasp.hpp"
#include "bin_picking_perception/grasping/grasp_expansion.hpp"
#include "bin_picking_perception/grasping/gripper.hpp"
#include "bin_picking_perception/grasping/tool_shape.hpp"
#include "bin_picking_perception/model/part.hpp"

namespace bin_picking
{
/// Why not; without a rejection: it may be.
struct Refusal
{
  GraspRejection rejection = GraspRejection::None;
  std::string reason;
};

/// What is the same wherever a grasp's part lies.
struct PreparedGrasp
{
  std::size_t as_written = 0;           ///< index of the grasp of which it is a copy around an axis, or its own
  Refusal refusal;                      ///< where the gripper cannot take it
  Pose T_tip_tool0 = Pose::Identity();  ///< when holding; not finite where the gripper does not have the width
  // The gripper's; empty where it cannot take it.
  ToolShape open, closing, closed;
  ToolShape way_in;           ///< what it covers from the pre-grasp to the grasp, in its frame at the pre-grasp
  double priority_share = 1;  ///< in the range of the part's priorities, [0, 1]
};

/// The grasps of a part with one gripper.
struct PreparedPart
{
  std::vector<PreparedGrasp> grasps;  ///< as in PartDefinition::grasps
  std::vector<GraspVariant> variants;
  std::size_t as_written = 0;  ///< so many of the variants come first and use no tolerance
  std::vector<Eigen::Vector3d>
      approaches_object;  ///< of the variants: unit directions, together so that they are read fast
};

PreparedPart preparePart(const PartDefinition& part, const Gripper& gripper, int continuous_steps);
}  // namespace bin_picking
