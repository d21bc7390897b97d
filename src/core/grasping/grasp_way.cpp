// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <limits>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/grasping/grasp_check.hpp"
#include "bin_picking_perception/grasping/tool_shape.hpp"
#include "surface_blocks.hpp"

namespace bin_picking
{
namespace
{
constexpr double PAD_ROOM = 0.002;  // metres of the opening before the width: where the pads' faces may be near
constexpr float TOUCH = 0.0002f;    // metres that a body may cut into samples of a surface that it only touches

/// Where a pad is along the closing axis of the open gripper, metres.
double middleOf(std::size_t pad, const Gripper& gripper)
{
  const Pose T_tip_tool0 = gripper.T_tool0_tip(gripper.max_opening).inverse();
  const ConvexBody body = transformed(gripper.bodyAt(pad, gripper.max_opening), T_tip_tool0);
  double sum = 0;
  for (const Eigen::Vector3d& v : body.vertices)
    sum += v.y();
  return sum / static_cast<double>(body.vertices.size());
}

void checkPads(const Gripper& gripper)
{
  std::vector<double> middles;
  for (std::size_t i = 0; i < gripper.bodies.size(); ++i)
    if (gripper.bodies[i].touches_part)
      middles.push_back(middleOf(i, gripper));
  if (gripper.kind != Gripper::Kind::Fingers || middles.size() < 2)
    throw ParameterError("the gripper '" + gripper.name +
                         "' has no two fingers (bodies with touches_part: true) between which a part could be checked; "
                         "grasps of a suction cup are not checked");
  const auto [lowest, highest] = std::minmax_element(middles.begin(), middles.end());
  if (!(*lowest < 0 && *highest > 0))
    throw ParameterError("all pads (bodies with touches_part: true) of the gripper '" + gripper.name +
                         "' lie on one side of its tip along the closing axis Y, so that no part could be held between "
                         "them; mark the pad of the other finger too, or correct position_xy and rotation_z_deg of the "
                         "tip");
}
}  // namespace

GraspChecker::GraspChecker(const TriangleMesh& mesh, const Gripper& gripper, const GraspCheckParameters& parameters)
    : mesh_(mesh), gripper_(gripper), parameters_(parameters)
{
  checkRanges(parameters);
  if (mesh.empty())
    throw ParameterError("the part has no triangles, and its grasps cannot be held against it; use a mesh");
  checkPads(gripper);
  std::vector<Eigen::Vector3f> points = sampleSurface(mesh, parameters.surface_spacing, 1).points;
  points.insert(points.end(), mesh.vertices.begin(), mesh.vertices.end());
  surface_ = std::make_shared<const SurfaceBlocks>(points);
}

// The tip of the grasp is where it is when holding; on the way in, the flange is in the same place and the fingers
// open.
void GraspChecker::approach(const GraspDefinition& grasp, const Pose& T_object_tip, GraspCheck& result) const
{
  const Pose T_object_start =
      T_object_tip * Eigen::Translation3d(0, 0, -grasp.approach) * gripper_.T_tool0_tip(grasp.width).inverse();
  const Eigen::Vector3d motion = grasp.approach * T_object_tip.linear().col(2);
  float nearest = std::numeric_limits<float>::infinity();
  Eigen::Vector3f at = Eigen::Vector3f::Zero();
  for (const ToolPiece& piece : shapeAt(gripper_, grasp.opening))
  {
    const float before = nearest;
    surface_->deepest(BodySweep(swept(transformed(piece.shape, T_object_start), motion)).planes, nearest, at);
    if (nearest < before)
      result.closest = piece.body;
  }
  result.clearance = static_cast<double>(nearest);
  result.closest_at = at.cast<double>();
}

double GraspChecker::closing(const GraspDefinition& grasp, const Pose& T_object_tip, double offset,
                             std::string& body) const
{
  const Pose T_object_tool0 =
      T_object_tip * Eigen::Translation3d(0, offset, 0) * gripper_.T_tool0_tip(grasp.width).inverse();
  float deepest = -TOUCH;
  Eigen::Vector3f at;
  const auto look = [&](double last, bool at_pads) {
    if (last > grasp.opening)
      return;
    for (const ToolPiece& piece : closingShape(gripper_, grasp.opening, last))
    {
      if (piece.may_touch_target != at_pads)
        continue;
      const float before = deepest;
      surface_->deepest(BodySweep(transformed(piece.shape, T_object_tool0)).planes, deepest, at);
      if (deepest < before)
        body = piece.body;
    }
  };
  look(grasp.width + PAD_ROOM, true);
  look(grasp.width, false);
  return deepest < -TOUCH ? static_cast<double>(deepest) : 0.0;
}
}  // namespace bin_picking
