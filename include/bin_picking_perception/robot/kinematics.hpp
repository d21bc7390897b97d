// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bin_picking_perception/robot/robot.hpp"

namespace bin_picking
{
/// How far the arm is from the poses at which it loses a direction of motion. All are 0 there.
struct SingularityMargin
{
  double wrist = 0;     ///< angle of wrist_2 from 0 or half a turn, rad: axes of wrist_1 and wrist_3 parallel
  double elbow = 0;     ///< angle of the elbow from stretched or folded, rad
  double shoulder = 0;  ///< distance of the wrist's centre (axes of wrist_2 and wrist_3) from the plane of the axes of
                        ///< shoulder_pan and shoulder_lift, metres
};

/// Forward and inverse kinematics in closed form, in the frame `base`. Immutable; safe to share between threads.
class Kinematics
{
public:
  /// The ways in which the arm can take a pose: shoulder, wrist and elbow, two each.
  static constexpr int NUM_BRANCHES = 8;

  /// \throws ParameterError the geometry is not that of Universal Robots' arms (see geometryFault)
  explicit Kinematics(Robot robot);

  const Robot& robot() const { return robot_; }

  /// \return T_base_tool0
  Pose forward(const Joints& joints) const;

  /// One of the ways to take a pose. Along a path that stays clear of the singularities a branch is continuous, but for
  /// whole turns of the joints.
  /// \param branch 0 ... 7: 4 * (shoulder beyond the wrist) + 2 * (wrist_2 negative) + (elbow negative)
  /// \param reference each joint is given within half a turn of it, whatever the limits. Where the pose leaves wrist_3
  /// open (wrist_2 at 0 or half a turn), wrist_3 is that of the reference.
  /// \return nothing if the pose cannot be taken so. forward() of the result is the pose to 1e-9.
  std::optional<Joints> branch(int branch, const Pose& T_base_tool0, const Joints& reference) const;

  /// All ways to take a pose within the joints' limits, in the order of the branches; equal ones (at a singularity) are
  /// given once. Each joint is that of its whole turns within the limits which is nearest to the reference.
  /// \throws ParameterError a pose that is not rigid or not finite
  std::vector<Joints> inverse(const Pose& T_base_tool0, const Joints& reference) const;

  /// The same, nearest to the robot's home.
  std::vector<Joints> inverse(const Pose& T_base_tool0) const { return inverse(T_base_tool0, robot_.home); }

  /// Turns each joint by whole turns to the value within its limits that is nearest to the reference, wherever that is.
  /// \return index of the first joint that has no such value; -1: none, and `joints` is changed
  int fitIntoLimits(Joints& joints, const Joints& reference) const;

  SingularityMargin singularityMargin(const Joints& joints) const;

  /// Why a pose is not taken, in a sentence with numbers.
  struct Fault
  {
    bool too_far = false;  ///< beyond the arm's length; otherwise too near to its shoulder
    std::string sentence;
  };
  /// Where no branch takes it: why the one that misses it by the least does not.
  Fault fault(const Pose& T_base_tool0) const;
  /// Why one branch does not take it, with the parameters of branch().
  Fault fault(int branch, const Pose& T_base_tool0, const Joints& reference) const;

private:
  /// The arm without its elbow: upper arm and forearm lie in a plane at a right angle to the axis of shoulder_lift (z
  /// of the frames 1 to 3), whose x is horizontal and whose y points up; they have to reach from its origin to the
  /// wrist.
  struct Plane
  {
    double pan, wrist_2, wrist_3;
    double lift_elbow_wrist_1;  ///< sum of the three joints whose axes are parallel
    double x, y;                ///< of the wrist (origin of frame 4)
    double length;              ///< of (x, y)
  };
  std::optional<Plane> plane(bool far_shoulder, bool negative_wrist, const Pose& T, double free_wrist_3) const;
  std::optional<Joints> bend(const Plane& plane, bool negative_elbow) const;

  Robot robot_;
};

/// \throws ParameterError a pose that is not finite or whose rotation part is no rotation, naming it by `what`
void requireRigid(const Pose& pose, const std::string& what);
}  // namespace bin_picking
