// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "prepared_part.hpp"

#include <algorithm>
#include <limits>

#include "bin_picking_perception/common/figures.hpp"

namespace bin_picking
{
namespace
{
/// A grasp without opening is one for a suction cup.
Refusal checkGripper(const GraspDefinition& definition, const Gripper& gripper)
{
  const bool by_suction = definition.opening == 0;
  if (by_suction && gripper.kind != Gripper::Kind::Suction)
    return {GraspRejection::OtherGripper,
            "The grasp is one for a suction cup (its opening is 0), the gripper \"" + gripper.name + "\" has fingers."};
  if (!by_suction && gripper.kind == Gripper::Kind::Suction)
    return {GraspRejection::OtherGripper, "The grasp is one for fingers (its opening is " +
                                              millimetres(definition.opening) + "), the gripper \"" + gripper.name +
                                              "\" is a suction cup."};
  if (!(definition.opening <= gripper.max_opening))
  {
    const auto [opening, most] = toldApart(definition.opening, gripper.max_opening, millimetres);
    return {GraspRejection::OpeningTooSmall, "The grasp asks for an opening of " + opening + ", the gripper \"" +
                                                 gripper.name + "\" opens to " + most + "."};
  }
  if (!(definition.width >= gripper.min_opening))
  {
    const auto [width, least] = toldApart(definition.width, gripper.min_opening, millimetres);
    return {GraspRejection::ClosingTooSmall,
            "The part is " + width + " wide there, the gripper \"" + gripper.name + "\" closes to " + least + "."};
  }
  return {};
}

Pose flangeOf(double width, const Gripper& gripper)
{
  if (width >= gripper.min_opening && width <= gripper.max_opening)
    return gripper.T_tool0_tip(width).inverse();
  Pose unknown = Pose::Identity();
  unknown.translation().setConstant(std::numeric_limits<double>::quiet_NaN());
  return unknown;
}

double priorityShare(int priority, const PartDefinition& part)
{
  const auto less = [](const GraspDefinition& a, const GraspDefinition& b) { return a.priority < b.priority; };
  const auto [lowest, highest] = std::minmax_element(part.grasps.begin(), part.grasps.end(), less);
  const double range = static_cast<double>(highest->priority) - lowest->priority;
  return range > 0 ? (static_cast<double>(priority) - lowest->priority) / range : 1.0;
}

/// Index of the grasp that this one repeats around an axis; its own if there is none.
std::size_t writtenAs(std::size_t g, const std::vector<GraspDefinition>& grasps)
{
  const auto written = std::find_if(grasps.begin(), grasps.end(), [&](const GraspDefinition& other) {
    return !grasps[g].copy_of.empty() && other.id == grasps[g].copy_of;
  });
  return written == grasps.end() ? g : static_cast<std::size_t>(written - grasps.begin());
}

bool usesTolerance(const GraspVariant& variant) { return variant.tilt != 0 || variant.spin != 0; }
}  // namespace

PreparedPart preparePart(const PartDefinition& part, const Gripper& gripper, int continuous_steps)
{
  PreparedPart prepared;
  for (const GraspDefinition& definition : part.grasps)
  {
    PreparedGrasp grasp;
    grasp.as_written = writtenAs(prepared.grasps.size(), part.grasps);
    grasp.refusal = checkGripper(definition, gripper);
    grasp.T_tip_tool0 = flangeOf(definition.width, gripper);
    if (grasp.refusal.rejection == GraspRejection::None)
    {
      grasp.open = shapeAt(gripper, definition.opening);
      grasp.closing = closingShape(gripper, definition.opening, definition.width);
      grasp.closed = shapeAt(gripper, definition.width);
      const Eigen::Vector3d along_tip(0, 0, definition.approach);
      grasp.way_in = movedBy(grasp.open, grasp.T_tip_tool0.linear().transpose() * along_tip);
    }
    grasp.priority_share = priorityShare(definition.priority, part);
    prepared.grasps.push_back(std::move(grasp));
  }
  prepared.variants = expandGrasps(part, continuous_steps);
  const auto first = std::find_if(prepared.variants.begin(), prepared.variants.end(), usesTolerance);
  prepared.as_written = static_cast<std::size_t>(first - prepared.variants.begin());
  for (const GraspVariant& variant : prepared.variants)
    prepared.approaches_object.push_back(variant.T_object_tip.linear().col(2));
  return prepared;
}
}  // namespace bin_picking
