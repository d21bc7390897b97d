// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <optional>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/figures.hpp"
#include "bin_picking_perception/robot/kinematics.hpp"

namespace bin_picking
{
namespace
{
/// From the shoulder to the wrist, metres.
struct Span
{
  explicit Span(const Robot& robot)
      : shortest(std::abs(robot.dh[1].a - robot.dh[2].a)), longest(std::abs(robot.dh[1].a + robot.dh[2].a))
  {}

  /// By how much a length is outside.
  double missedBy(double length) const { return std::max(length - longest, shortest - length); }

  double shortest, longest;
};

Kinematics::Fault lengthFault(double length, const Robot& robot)
{
  const Span span(robot);
  const bool too_far = length - span.longest > span.shortest - length;
  const auto [figure, limit] = toldApart(length, too_far ? span.longest : span.shortest, metres, 3);
  return {too_far, "the wrist would be " + figure + " from the shoulder, the " + robot.name +
                       (too_far ? " reaches " : " cannot fold closer than ") + limit};
}

Kinematics::Fault axisFault(const Pose& T_base_tool0, const Robot& robot)
{
  const Eigen::Vector3d center = T_base_tool0.translation() - robot.dh[5].d * T_base_tool0.linear().col(2);
  const auto [figure, limit] = toldApart(std::hypot(center.x(), center.y()), robot.dh[3].d, metres, 3);
  return {false, "the wrist would be " + figure + " from the vertical axis of the base, the " + robot.name +
                     " cannot come nearer than " + limit};
}
}  // namespace

std::string geometryFault(const Robot& robot)
{
  constexpr std::array<double, 6> TWISTS = {M_PI_2, 0, 0, M_PI_2, -M_PI_2, 0};
  const std::string cure =
      "; the closed-form kinematics hold for the nominal geometry of Universal Robots' arms only "
      "(not for the values of a factory calibration)";
  for (std::size_t k = 0; k < 6; ++k)
  {
    const DhRow& row = robot.dh[k];
    const std::string joint = "joint " + std::to_string(k + 1) + " of the robot '" + robot.name + "' ";
    if (!std::isfinite(row.a) || !std::isfinite(row.d) || !(std::abs(row.alpha - TWISTS[k]) < 1e-9))
      return joint + "has an 'alpha' of " + std::to_string(row.alpha * 180 / M_PI) + " deg, but it must be " +
             std::to_string(TWISTS[k] * 180 / M_PI) + " deg" + cure;
    const bool is_link = k == 1 || k == 2;
    if (is_link ? std::abs(row.a) < 1e-3 : row.a != 0)
      return joint + "has an 'a' of " + metres(row.a) + ", but it must " + (is_link ? "not be 0" : "be 0") + cure;
    if (is_link && row.d != 0)
      return joint + "has a 'd' of " + metres(row.d) + ", but it must be 0" + cure;
  }
  if (robot.dh[1].a * robot.dh[2].a < 0)
    return "upper arm and forearm of the robot '" + robot.name + "' have an 'a' of different sign" + cure;
  if (!(robot.dh[3].d > 0))
    return "joint 4 of the robot '" + robot.name + "' has a 'd' of " + metres(robot.dh[3].d) +
           ", but it must be positive" + cure;
  return "";
}

void requireRigid(const Pose& pose, const std::string& what)
{
  constexpr double MAX_ERROR = 1e-6;
  const Eigen::Matrix3d R = pose.linear();
  if (!pose.matrix().allFinite())
    throw ParameterError(what + " is not finite; do not pass on the pose of a failure");
  if (!((R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < MAX_ERROR) || R.determinant() < 0)
    throw ParameterError(what +
                         " is not rigid: its axes are not of length 1 and at right angles, right-handed, to "
                         "1e-6; build it from a rotation and a position only");
}

Kinematics::Fault Kinematics::fault(int branch, const Pose& T_base_tool0, const Joints& reference) const
{
  const auto p = plane((branch & 4) != 0, (branch & 2) != 0, T_base_tool0, reference[5]);
  return p ? lengthFault(p->length, robot_) : axisFault(T_base_tool0, robot_);
}

Kinematics::Fault Kinematics::fault(const Pose& T_base_tool0) const
{
  const Span span(robot_);
  std::optional<double> nearest;
  for (const bool far_shoulder : {false, true})
    for (const bool negative_wrist : {false, true})
      if (const auto p = plane(far_shoulder, negative_wrist, T_base_tool0, 0))
        if (!nearest || span.missedBy(p->length) < span.missedBy(*nearest))
          nearest = p->length;
  return nearest ? lengthFault(*nearest, robot_) : axisFault(T_base_tool0, robot_);
}
}  // namespace bin_picking
