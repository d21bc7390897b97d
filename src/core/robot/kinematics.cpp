// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/robot/kinematics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
constexpr double TWO_PI = 2 * M_PI;
constexpr double EPSILON = 1e-10;  // metres or sines: rounding errors of a pose that just touches a limit of the arm

double nearestTurn(double angle, double reference) { return angle + TWO_PI * std::round((reference - angle) / TWO_PI); }

/// sqrt(a^2 - b^2); a little less than 0 counts as 0, more of it is NaN.
double otherLeg(double a, double b)
{
  const double difference = a - b;
  if (difference < -EPSILON)
    return std::numeric_limits<double>::quiet_NaN();
  return std::sqrt(std::max(difference, 0.0) * (a + b));
}

bool sameUpToTurns(const Joints& a, const Joints& b)
{
  constexpr double SAME = 1e-7;  // next to a singularity two branches differ by the root of the rounding error
  for (int k = 0; k < 6; ++k)
    if (std::abs(std::remainder(a[k] - b[k], TWO_PI)) > SAME)
      return false;
  return true;
}
}  // namespace

Kinematics::Kinematics(Robot robot) : robot_(std::move(robot))
{
  if (const std::string fault = geometryFault(robot_); !fault.empty())
    throw ParameterError(fault);
}

Pose Kinematics::forward(const Joints& joints) const
{
  Pose T = Pose::Identity();
  for (int k = 0; k < 6; ++k)
  {
    const DhRow& row = robot_.dh[static_cast<std::size_t>(k)];
    const double c = std::cos(joints[k]), s = std::sin(joints[k]);
    const double ca = std::abs(row.alpha) < 1 ? 1.0 : 0.0;  // the twists are 0 or a right angle, exactly
    const double sa = ca > 0 ? 0.0 : std::copysign(1.0, row.alpha);
    Pose link;
    link.matrix() << c, -s * ca, s * sa, row.a * c,  //
        s, c * ca, -c * sa, row.a * s,               //
        0, sa, ca, row.d,                            //
        0, 0, 0, 1;
    T = T * link;
  }
  return T;
}

// The wrist's centre (origin of frame 5) lies d4 off the plane that shoulder_pan turns: that gives shoulder_pan. The
// normal z1 of the plane, seen from the flange, is (s5 c6, -s5 s6, c5): that gives wrist_2 and wrist_3. The rest is in
// the plane.
std::optional<Kinematics::Plane> Kinematics::plane(bool far_shoulder, bool negative_wrist, const Pose& T,
                                                   double free_wrist_3) const
{
  const auto& dh = robot_.dh;
  const Eigen::Matrix3d R = T.linear();
  const Eigen::Vector3d center = T.translation() - dh[5].d * R.col(2);
  const double along = otherLeg(std::hypot(center.x(), center.y()), dh[3].d);
  if (std::isnan(along))
    return std::nullopt;
  Plane p;
  // sin(pan) x - cos(pan) y = d4 has two solutions: the wrist before or behind the shoulder.
  p.pan = std::atan2(center.y(), center.x()) + std::atan2(dh[3].d, far_shoulder ? -along : along);
  const Eigen::Vector3d radial(std::cos(p.pan), std::sin(p.pan), 0);
  const Eigen::Vector3d normal(radial.y(), -radial.x(), 0);
  const Eigen::Vector3d seen = R.transpose() * normal;
  const double sine = std::hypot(seen.x(), seen.y());
  const double sign = negative_wrist ? -1 : 1;
  p.wrist_2 = std::atan2(sign * sine, seen.z());
  p.wrist_3 = sine > EPSILON ? std::atan2(-sign * seen.y(), sign * seen.x()) : free_wrist_3;
  // The axes of frame 4, seen from the flange by the last two links, seen from the base by R.
  const double c5 = seen.z(), s5 = sign * sine, c6 = std::cos(p.wrist_3), s6 = std::sin(p.wrist_3);
  const Eigen::Vector3d x4 = R * Eigen::Vector3d(c5 * c6, -c5 * s6, -s5);
  const Eigen::Vector3d z4 = R * Eigen::Vector3d(-s6, -c6, 0);
  p.lift_elbow_wrist_1 = std::atan2(x4.z(), x4.dot(radial));
  const Eigen::Vector3d wrist = center - dh[4].d * z4;
  p.x = wrist.dot(radial);
  p.y = wrist.z() - dh[0].d;
  p.length = std::hypot(p.x, p.y);
  return p;
}

// Law of cosines, by half the angle: exact also where the elbow is nearly stretched or folded.
std::optional<Joints> Kinematics::bend(const Plane& p, bool negative_elbow) const
{
  const double upper = robot_.dh[1].a, fore = robot_.dh[2].a;
  const double stretched = otherLeg(std::abs(upper + fore), p.length);
  const double folded = otherLeg(p.length, std::abs(upper - fore));
  if (std::isnan(stretched) || std::isnan(folded))
    return std::nullopt;
  const double elbow = (negative_elbow ? -2 : 2) * std::atan2(stretched, folded);
  const double lift = std::atan2(p.y, p.x) - std::atan2(fore * std::sin(elbow), upper + fore * std::cos(elbow));
  Joints joints;
  joints << p.pan, lift, elbow, p.lift_elbow_wrist_1 - lift - elbow, p.wrist_2, p.wrist_3;
  return joints;
}

std::optional<Joints> Kinematics::branch(int branch, const Pose& T_base_tool0, const Joints& reference) const
{
  const auto p = plane((branch & 4) != 0, (branch & 2) != 0, T_base_tool0, reference[5]);
  if (!p)
    return std::nullopt;
  auto joints = bend(*p, (branch & 1) != 0);
  if (joints)
    for (int k = 0; k < 6; ++k)
      (*joints)[k] = nearestTurn((*joints)[k], reference[k]);
  return joints;
}

std::vector<Joints> Kinematics::inverse(const Pose& T_base_tool0, const Joints& reference) const
{
  requireRigid(T_base_tool0, "the pose of tool0");
  std::vector<Joints> solutions;
  for (int k = 0; k < NUM_BRANCHES; ++k)
  {
    auto joints = branch(k, T_base_tool0, reference);
    if (!joints || fitIntoLimits(*joints, reference) >= 0)
      continue;
    const auto same = [&](const Joints& other) { return sameUpToTurns(other, *joints); };
    if (std::none_of(solutions.begin(), solutions.end(), same))
      solutions.push_back(*joints);
  }
  return solutions;
}

int Kinematics::fitIntoLimits(Joints& joints, const Joints& reference) const
{
  Joints fitted = joints;
  for (int k = 0; k < 6; ++k)
  {
    const double nearest = nearestTurn(joints[k], std::clamp(reference[k], robot_.lower[k], robot_.upper[k]));
    const auto within = [&](double angle) { return angle >= robot_.lower[k] && angle <= robot_.upper[k]; };
    fitted[k] = nearest;
    if (!within(nearest))
      fitted[k] += nearest > robot_.upper[k] ? -TWO_PI : TWO_PI;
    if (!within(fitted[k]))
      return k;
  }
  joints = fitted;
  return -1;
}

SingularityMargin Kinematics::singularityMargin(const Joints& q) const
{
  const auto& dh = robot_.dh;
  SingularityMargin margin;
  margin.wrist = std::abs(std::remainder(q[4], M_PI));
  margin.elbow = std::abs(std::remainder(q[2], M_PI));
  margin.shoulder =
      std::abs(dh[1].a * std::cos(q[1]) + dh[2].a * std::cos(q[1] + q[2]) + dh[4].d * std::sin(q[1] + q[2] + q[3]));
  return margin;
}
}  // namespace bin_picking
