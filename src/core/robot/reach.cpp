// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/robot/reach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/figures.hpp"

namespace bin_picking
{
namespace
{
constexpr double MAX_TURN_STEP = 0.05;  // rad of the flange between two poses that are tried

/// What fails, and how far the way went until there: whole waypoints and the share of the line to the next.
struct Fault
{
  Reach::Failure kind;
  std::string sentence;
  double progress;
};

/// One request being followed.
class Follower
{
public:
  Follower(const Kinematics& kinematics, const ReachRequest& request, const ReachParameters& parameters)
      : kinematics_(kinematics), waypoints_(request.waypoints_base_tool0), parameters_(parameters)
  {}

  /// The joints at the waypoints, or what is wrong with them before any line is followed.
  std::optional<Fault> tryWaypoints(int branch) const
  {
    Joints reference = kinematics_.robot().home;
    for (std::size_t w = 0; w < waypoints_.size(); ++w)
    {
      const auto joints = kinematics_.branch(branch, waypoints_[w], reference);
      if (!joints)
        return unreachable(kinematics_.fault(branch, waypoints_[w], reference), static_cast<double>(w));
      if (auto fault = tooSingular(kinematics_.singularityMargin(*joints), static_cast<double>(w)))
        return fault;
      reference = *joints;
    }
    return std::nullopt;
  }

  /// Follows all lines in one branch. \param result gets the joints
  std::optional<Fault> follow(int branch, Reach& result) const
  {
    Joints joints = *kinematics_.branch(branch, waypoints_.front(), kinematics_.robot().home);
    if (const int joint = kinematics_.fitIntoLimits(joints, kinematics_.robot().home); joint >= 0)
      return beyondLimit(joint, joints[joint], 0);
    result.joints = {joints};
    for (std::size_t w = 1; w < waypoints_.size(); ++w)
    {
      if (auto fault = followLine(branch, w, joints))
        return fault;
      result.joints.push_back(joints);
    }
    return std::nullopt;
  }

  static Fault unreachable(const Kinematics::Fault& fault, double progress)
  {
    return {fault.too_far ? Reach::Failure::OutOfReach : Reach::Failure::NoSolution, fault.sentence, progress};
  }

private:
  std::optional<Fault> followLine(int branch, std::size_t w, Joints& joints) const
  {
    const Pose& from = waypoints_[w - 1];
    const Pose& to = waypoints_[w];
    const Eigen::Vector3d motion = to.translation() - from.translation();
    const Eigen::AngleAxisd turn(from.linear().transpose() * to.linear());
    const int steps = std::max(1, static_cast<int>(std::ceil(std::max(motion.norm() / parameters_.path_step,
                                                                      std::abs(turn.angle()) / MAX_TURN_STEP))));
    for (int i = 1; i <= steps; ++i)
    {
      const double share = static_cast<double>(i) / steps;
      Pose pose = i == steps ? to : from;
      if (i < steps)
      {
        pose.translation() += share * motion;
        if (turn.angle() > 1e-9)
          pose.linear() = from.linear() * Eigen::AngleAxisd(share * turn.angle(), turn.axis()).toRotationMatrix();
      }
      if (auto fault = step(branch, pose, static_cast<double>(w - 1) + share, joints))
        return fault;
    }
    return std::nullopt;
  }

  std::optional<Fault> step(int branch, const Pose& pose, double progress, Joints& joints) const
  {
    const auto next = kinematics_.branch(branch, pose, joints);
    if (!next)
      return unreachable(kinematics_.fault(branch, pose, joints), progress);
    if (auto fault = tooSingular(kinematics_.singularityMargin(*next), progress))
      return fault;
    for (int k = 0; k < 6; ++k)
      if ((*next)[k] < kinematics_.robot().lower[k] || (*next)[k] > kinematics_.robot().upper[k])
        return beyondLimit(k, (*next)[k], progress);
    int joint = 0;
    if (const double jump = (*next - joints).cwiseAbs().maxCoeff(&joint); jump > parameters_.max_joint_step)
    {
      const FigureAndLimit told = toldApart(jump, parameters_.max_joint_step, degrees);
      return Fault{Reach::Failure::Discontinuous,
                   jointName(joint) + " would have to turn by " + told.figure +
                       " between neighbouring poses of the way, at most " + told.limit +
                       " are allowed (max_joint_step)",
                   progress};
    }
    joints = *next;
    return std::nullopt;
  }

  std::optional<Fault> tooSingular(const SingularityMargin& margin, double progress) const
  {
    const auto fault = [&](const std::string& what, const std::string& from, const FigureAndLimit& told,
                           const char* parameter) {
      return Fault{Reach::Failure::Singular,
                   what + " would be " + told.figure + " from " + from + ", at least " + told.limit +
                       " are required (" + parameter + ")",
                   progress};
    };
    if (margin.wrist < parameters_.min_wrist_angle)
      return fault(jointName(4), "the singularity of the wrist",
                   toldApart(margin.wrist, parameters_.min_wrist_angle, degrees), "min_wrist_angle");
    if (margin.elbow < parameters_.min_elbow_angle)
      return fault("the elbow", "being stretched or folded",
                   toldApart(margin.elbow, parameters_.min_elbow_angle, degrees), "min_elbow_angle");
    if (margin.shoulder < parameters_.min_shoulder_distance)
      return fault("the wrist", "the plane of the shoulder's axes",
                   toldApart(margin.shoulder, parameters_.min_shoulder_distance, millimetres), "min_shoulder_distance");
    return std::nullopt;
  }

  Fault beyondLimit(int joint, double angle, double progress) const
  {
    const Robot& robot = kinematics_.robot();
    return {Reach::Failure::JointLimit,
            jointName(joint) + " would have to turn to " + degrees(angle) + ", its limits are " +
                degrees(robot.lower[joint]) + " and " + degrees(robot.upper[joint]),
            progress};
  }

  std::string jointName(int joint) const { return kinematics_.robot().joint_names[static_cast<std::size_t>(joint)]; }

  const Kinematics& kinematics_;
  const std::vector<Pose>& waypoints_;
  const ReachParameters& parameters_;
};

/// The branches that take the first waypoint, the one nearest to the home pose first, as the limits of the joints let
/// it be; those that do not fit into the limits last.
std::vector<int> preferredBranches(const Kinematics& kinematics, const Pose& first)
{
  const Joints& home = kinematics.robot().home;
  std::vector<std::tuple<bool, double, int>> order;
  for (int k = 0; k < Kinematics::NUM_BRANCHES; ++k)
    if (auto joints = kinematics.branch(k, first, home))
    {
      const bool is_beyond = kinematics.fitIntoLimits(*joints, home) >= 0;
      order.emplace_back(is_beyond, (*joints - home).squaredNorm(), k);
    }
  std::sort(order.begin(), order.end());
  std::vector<int> branches;
  for (const auto& entry : order)
    branches.push_back(std::get<int>(entry));
  return branches;
}

std::string where(double progress, std::size_t num_waypoints)
{
  const auto name = [&](std::size_t w) -> std::string {
    static const std::array<const char*, 3> NAMES = {"pre-grasp", "grasp", "retreat"};
    return num_waypoints == 3 ? NAMES[w] : "waypoint " + std::to_string(w + 1);
  };
  const double whole = std::floor(progress);
  const auto w = static_cast<std::size_t>(whole);
  if (progress == whole)
    return "at the " + name(w);
  return std::to_string(static_cast<int>(100 * (progress - whole))) + " % of the way from " + name(w) + " to " +
         name(w + 1);
}

Reach failed(const Fault& fault, std::size_t num_waypoints)
{
  Reach result;
  result.failure = fault.kind;
  result.waypoint = static_cast<std::size_t>(std::ceil(fault.progress));
  result.reason = where(fault.progress, num_waypoints) + ", " + fault.sentence + ".";
  result.reason[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(result.reason[0])));
  return result;
}
}  // namespace

Reach reach(const Kinematics& kinematics, const ReachRequest& request, const ReachParameters& parameters)
{
  checkRanges(parameters);
  const std::vector<Pose>& waypoints = request.waypoints_base_tool0;
  if (waypoints.empty())
    throw ParameterError("the reach of no waypoint was asked for; give at least one pose of tool0");
  for (std::size_t w = 0; w < waypoints.size(); ++w)
    requireRigid(waypoints[w], "waypoint " + std::to_string(w + 1) + " of the way of tool0");

  const Follower follower(kinematics, request, parameters);
  const std::vector<int> branches = preferredBranches(kinematics, waypoints.front());
  if (branches.empty())
    return failed(Follower::unreachable(kinematics.fault(waypoints.front()), 0), waypoints.size());
  std::optional<Fault> farthest;
  for (const int branch : branches)
  {
    Reach result;
    std::optional<Fault> fault = follower.tryWaypoints(branch);
    if (!fault)
      fault = follower.follow(branch, result);
    if (!fault)
      return result;
    if (!farthest || fault->progress > farthest->progress)
      farthest = fault;
  }
  return failed(*farthest, waypoints.size());
}
}  // namespace bin_picking
