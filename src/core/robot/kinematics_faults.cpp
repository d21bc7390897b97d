// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <locale>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/robot/kinematics.hpp"

namespace bin_picking
{
namespace
{
std::string metres(double value)
{
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream << std::fixed << std::setprecision(3) << value << " m";
  return stream.str();
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

Kinematics::Fault Kinematics::fault(const Pose& T_base_tool0) const
{
  const double longest = std::abs(robot_.dh[1].a + robot_.dh[2].a);
  const double shortest = std::abs(robot_.dh[1].a - robot_.dh[2].a);
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
  for (const bool far_shoulder : {false, true})
    for (const bool negative_wrist : {false, true})
      if (const auto p = plane(far_shoulder, negative_wrist, T_base_tool0, 0))
      {
        nearest = std::min(nearest, p->length);
        farthest = std::max(farthest, p->length);
      }
  if (!std::isfinite(nearest))
  {
    const Eigen::Vector3d center = T_base_tool0.translation() - robot_.dh[5].d * T_base_tool0.linear().col(2);
    return {false, "the wrist would be " + metres(std::hypot(center.x(), center.y())) +
                       " from the vertical axis of the base, the " + robot_.name + " cannot come nearer than " +
                       metres(robot_.dh[3].d)};
  }
  if (nearest > longest)
    return {true, "the wrist would be " + metres(nearest) + " from the shoulder, the " + robot_.name + " reaches " +
                      metres(longest)};
  return {false, "the wrist would be " + metres(farthest) + " from the shoulder, the " + robot_.name +
                     " cannot fold closer than " + metres(shortest)};
}
}  // namespace bin_picking
