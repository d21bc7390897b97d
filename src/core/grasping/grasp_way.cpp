// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <limits>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/grasping/grasp_check.hpp"

namespace bin_picking
{
namespace
{
constexpr double CLOSING_STEP = 0.002;  // metres of the opening
constexpr double TOUCH = 0.0002;        // metres that a body may cut into samples of a surface that it only touches

/// A body with the box round it, to pass over points that are farther than the nearest so far.
struct BoxedBody
{
  explicit BoxedBody(ConvexBody b) : body(std::move(b)), low(body.vertices.front()), high(low)
  {
    for (const Eigen::Vector3d& v : body.vertices)
    {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
  }

  ConvexBody body;
  Eigen::Vector3d low, high;
};

struct Nearest
{
  double distance = std::numeric_limits<double>::infinity();
  std::size_t point = 0;
};

void findNearest(const BoxedBody& boxed, const std::vector<Eigen::Vector3d>& points, Nearest& nearest)
{
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const double outside = (boxed.low - points[i]).cwiseMax(points[i] - boxed.high).maxCoeff();
    if (outside >= nearest.distance)
      continue;
    const double distance = signedDistance(boxed.body, points[i]);
    if (distance < nearest.distance)
      nearest = {distance, i};
  }
}
}  // namespace

GraspChecker::GraspChecker(const TriangleMesh& mesh, const Gripper& gripper, const GraspCheckParameters& parameters)
    : mesh_(mesh), gripper_(gripper), parameters_(parameters)
{
  checkRanges(parameters);
  if (mesh.empty())
    throw ParameterError("the part has no triangles, and its grasps cannot be held against it; use a mesh");
  const auto isPad = [](const GripperBody& body) { return body.touches_part; };
  if (gripper.kind != Gripper::Kind::Fingers || std::count_if(gripper.bodies.begin(), gripper.bodies.end(), isPad) < 2)
    throw ParameterError("the gripper '" + gripper.name +
                         "' has no two fingers (bodies with touches_part: true) between which a part could be checked; "
                         "grasps of a suction cup are not checked");
  surface_ = sampleSurface(mesh, parameters.surface_spacing, 1).points;
  surface_.insert(surface_.end(), mesh.vertices.begin(), mesh.vertices.end());
}

std::vector<Eigen::Vector3d> GraspChecker::surfaceIn(const Pose& T_object_tip) const
{
  const Pose T_tip_object = T_object_tip.inverse();
  std::vector<Eigen::Vector3d> points;
  points.reserve(surface_.size());
  for (const Eigen::Vector3f& p : surface_)
    points.push_back(T_tip_object * p.cast<double>());
  return points;
}

// The tip of the grasp is where it is when holding; on the way in, the flange is in the same place and the fingers
// open.
void GraspChecker::approach(const GraspDefinition& grasp, const Pose& T_object_tip, GraspCheck& result) const
{
  const std::vector<Eigen::Vector3d> points = surfaceIn(T_object_tip);
  const Pose T_tip_tool0 = gripper_.T_tool0_tip(grasp.width).inverse();
  const Pose T_tip_start = Eigen::Translation3d(0, 0, -grasp.approach) * T_tip_tool0;
  Nearest nearest;
  for (std::size_t b = 0; b < gripper_.bodies.size(); ++b)
  {
    const ConvexBody start = transformed(gripper_.bodyAt(b, grasp.opening), T_tip_start);
    const double before = nearest.distance;
    findNearest(BoxedBody(swept(start, Eigen::Vector3d(0, 0, grasp.approach))), points, nearest);
    if (nearest.distance < before)
      result.closest = gripper_.bodies[b].name;
  }
  result.clearance = nearest.distance;
  result.closest_at = surface_[nearest.point].cast<double>();
}

double GraspChecker::closing(const GraspDefinition& grasp, const Pose& T_object_tip, double offset,
                             std::string& body) const
{
  Pose T_object_centred = T_object_tip;
  T_object_centred.translation() += offset * T_object_tip.linear().col(1);
  const std::vector<Eigen::Vector3d> points = surfaceIn(T_object_centred);
  const Pose T_tip_tool0 = gripper_.T_tool0_tip(grasp.width).inverse();
  double deepest = 0;
  const auto look = [&](std::size_t b, double opening) {
    Nearest nearest;
    nearest.distance = -TOUCH;
    findNearest(BoxedBody(transformed(gripper_.bodyAt(b, opening), T_tip_tool0)), points, nearest);
    if (nearest.distance >= std::min(deepest, -TOUCH))
      return;
    deepest = nearest.distance;
    body = gripper_.bodies[b].name;
  };
  for (std::size_t b = 0; b < gripper_.bodies.size(); ++b)
  {
    // The pads' faces may come near, the others stay where they are when the part is held.
    const double last = grasp.width + (gripper_.bodies[b].touches_part ? CLOSING_STEP : 0);
    for (double opening = grasp.opening; opening > last; opening -= CLOSING_STEP)
      look(b, opening);
    if (last <= grasp.opening)
      look(b, last);
  }
  return deepest;
}
}  // namespace bin_picking
