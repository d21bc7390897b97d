// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// The whole loop of a picking cell: ask for the best grasp, make the moves, grip, report, until the bin is empty. The
// arm is a picture (KinematicArm) and the grip is that of the virtual cell; in a real cell these two are the robot's
// driver and the gripper's. scripts/ur5e_picker.py is the same program in Python.
//
// Parameters: ~frame (base: that of the controller, in which URScript is written), ~robot (YAML file), ~speed (1: about
// that of the robot; more is faster), ~max_fruitless (attempts in a row that take nothing; then the rest is left).
// Where nothing is allowed it shakes the bin and forgets the places that the detector avoids.
// Exit code 0: the bin is empty; 1: parts are left (also where the detector sees none), or an error.
#include <bin_picking_perception/GetBestGrasp.h>
#include <bin_picking_perception/Grip.h>
#include <bin_picking_perception/ReportPick.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <cstdint>
#include <cstdio>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>

#include "bin_picking_perception/robot/urscript.hpp"
#include "kinematic_arm.hpp"
#include "pose_conversion.hpp"
#include "resource_path.hpp"

using bin_picking_perception::GetBestGrasp;
using bin_picking_perception::Grasp;
using bin_picking_perception::Grip;
using bin_picking_perception::ReportPick;
using bin_picking_perception::ReturnCode;

namespace
{
constexpr double JOINT_SPEED = 1.05;  // rad/s, what a UR5e is programmed with by default
constexpr double PATIENCE = 120;  // seconds for everything to start; training a part for the first time takes a while

template <typename Service>
ros::ServiceClient connect(ros::NodeHandle& nh, const std::string& name)
{
  ros::ServiceClient client = nh.serviceClient<Service>(name);
  if (!client.waitForExistence(ros::Duration(PATIENCE)))
    throw std::runtime_error("The service " + client.getService() + " did not appear within 120 s.");
  return client;
}

template <typename Service>
typename Service::Response call(ros::ServiceClient& client, const typename Service::Request& request)
{
  typename Service::Response response;
  if (!client.call(request, response))
    throw std::runtime_error("The service " + client.getService() + " is gone.");
  return response;
}

/// Errors of one moment. A few of them in a row end the program as attempts do that take nothing.
bool mayPass(const ReturnCode& code)
{
  return code.value == ReturnCode::DEADLINE || code.value == ReturnCode::NO_CLOUD ||
         code.value == ReturnCode::TF_EXTRAPOLATION;
}

class Picker
{
public:
  Picker(ros::NodeHandle nh, const ros::NodeHandle& private_nh)
      : get_best_grasp_(connect<GetBestGrasp>(nh, "detector/get_best_grasp")),
        report_pick_(connect<ReportPick>(nh, "detector/report_pick")),
        clear_avoid_list_(connect<std_srvs::Trigger>(nh, "detector/clear_avoid_list")),
        grip_(connect<Grip>(nh, "virtual_cell/grip")),
        shake_(connect<std_srvs::Trigger>(nh, "virtual_cell/shake")),
        arm_(nh,
             bin_picking::loadRobot(bin_picking_ros::resolveResource(
                 private_nh.param<std::string>("robot", "package://bin_picking_perception/config/robots/ur5e.yaml"))),
             JOINT_SPEED * private_nh.param("speed", 1.0)),
        frame_(private_nh.param<std::string>("frame", "base")),
        max_fruitless_(private_nh.param("max_fruitless", 12))
  {}

  /// \return whether the bin is empty
  bool run()
  {
    for (int fruitless = 0; fruitless < max_fruitless_ && ros::ok();)
    {
      const GetBestGrasp::Response answer = ask();
      if (answer.code.value == ReturnCode::BIN_EMPTY)
        return endAtEmptyBin(answer.code);
      ++fruitless;
      if (!answer.grasps.empty())
      {
        if (pick(answer.grasps.front()))
          fruitless = 0;
        continue;
      }
      std::printf("      %s: %s (%s)\n", answer.code.name.c_str(), answer.code.message.c_str(), answer.summary.c_str());
      ++causes_[answer.code.name];
      if (answer.code.value > 0)
        shake();
    }
    std::printf("      Given up: %d attempts in a row took nothing (max_fruitless).\n", max_fruitless_);
    return false;
  }

  void printSummary() const
  {
    std::printf("%d attempts: %d picked", num_attempts_, num_picked_);
    for (const auto& [cause, count] : causes_)
      std::printf(", %d %s", count, cause.c_str());
    const std::string left = num_left_ ? std::to_string(*num_left_) + " left" : "nothing tried";
    std::printf("; %s after %.0f s\n", left.c_str(), (ros::WallTime::now() - start_).toSec());
  }

private:
  /// The detector tells by what is measured, the gripper by what it took: a bin is empty where they agree.
  /// \return whether it is
  bool endAtEmptyBin(const ReturnCode& code) const
  {
    if (num_left_.value_or(0) == 0)
      return true;
    std::printf(
        "      %s: %s. But %u parts are left, which the sensor does not measure or that lean on the walls; look "
        "into the bin.\n",
        code.name.c_str(), code.message.c_str(), *num_left_);
    return false;
  }

  /// The first answer comes when the models are loaded, the bin is full and tf is known; from then on, every error is
  /// one. \throws std::runtime_error an error that a person has to look at
  GetBestGrasp::Response ask()
  {
    GetBestGrasp::Request request;
    request.acquisition = GetBestGrasp::Request::WAIT_NEW;
    request.output_frame = frame_;
    request.accept_undetermined_turn = true;  // out of the bin is out, however turned
    GetBestGrasp::Response answer;
    do
      answer = call<GetBestGrasp>(get_best_grasp_, request);
    while (!has_started_ && answer.code.value < 0 && (ros::WallTime::now() - start_).toSec() < PATIENCE &&
           ros::WallDuration(0.5).sleep() && ros::ok());
    has_started_ = true;
    if (answer.code.value < 0 && !mayPass(answer.code))
      throw std::runtime_error(answer.code.name + ": " + answer.code.message + " " + answer.code.hint);
    return answer;
  }

  /// \return whether the part is out of the bin
  bool pick(const Grasp& grasp)
  {
    ++num_attempts_;
    std::printf("%4d  %-10s %s of %s, quality %.2f: %s\n", num_attempts_, grasp.uid.c_str(), grasp.grasp_id.c_str(),
                grasp.part.c_str(), grasp.quality,
                bin_picking::toUrScriptMove(bin_picking_ros::fromMessage(grasp.grasp_tool0)).c_str());
    move(grasp.joints_pre_grasp);
    move(grasp.joints_grasp);
    const Grip::Response result = grip(grasp);
    move(grasp.joints_retreat);
    arm_.goHome();

    std::printf("      %s\n", result.what.c_str());
    report(grasp, result);
    num_left_ = result.num_left;
    const bool is_picked = result.outcome == Grip::Response::TAKEN;
    if (is_picked)
      ++num_picked_;
    else
      ++causes_[outcomeName(result.outcome)];
    std::fflush(stdout);
    return is_picked;
  }

  /// Where nothing is allowed, the parts have to lie otherwise; what failed lies elsewhere then.
  void shake()
  {
    const std_srvs::Trigger::Response shaken = call<std_srvs::Trigger>(shake_, {});
    if (!shaken.success)
      throw std::runtime_error("The bin could not be shaken: " + shaken.message);
    std::printf("      %s\n", shaken.message.c_str());
    call<std_srvs::Trigger>(clear_avoid_list_, {});
  }

  void move(const std::vector<double>& joints)
  {
    if (joints.size() == 6)  // empty: reach was not checked, so that there is nothing to show
      arm_.moveTo(Eigen::Map<const bin_picking::Joints>(joints.data()));
  }

  Grip::Response grip(const Grasp& grasp)
  {
    Grip::Request request;
    request.pre_grasp.header = request.grasp.header = request.retreat.header = grasp.header;
    request.pre_grasp.pose = grasp.pre_grasp_tool0;
    request.grasp.pose = grasp.grasp_tool0;
    request.retreat.pose = grasp.retreat_tool0;
    request.opening = grasp.opening;
    request.width = grasp.width;
    request.part = grasp.part;
    const Grip::Response result = call<Grip>(grip_, request);
    if (result.outcome < 0)
      throw std::runtime_error("The grip could not be made: " + result.what);
    return result;
  }

  static const char* outcomeName(int outcome)
  {
    switch (outcome)
    {
      case Grip::Response::TAKEN:
        return "picked";
      case Grip::Response::MISSED:
        return "missed";
      case Grip::Response::DROPPED_BACK:
        return "dropped";
      default:
        return "collision";
    }
  }

  /// So that the detector does not offer again what has just failed.
  void report(const Grasp& grasp, const Grip::Response& result)
  {
    static const std::map<std::string, std::uint8_t> OUTCOMES = {{"picked", ReportPick::Request::PICKED},
                                                                 {"missed", ReportPick::Request::MISSED},
                                                                 {"dropped", ReportPick::Request::DROPPED},
                                                                 {"collision", ReportPick::Request::COLLISION}};
    ReportPick::Request request;
    request.grasp_uid = grasp.uid;
    request.outcome = OUTCOMES.at(outcomeName(result.outcome));
    request.note = result.what;
    const ReportPick::Response answer = call<ReportPick>(report_pick_, request);
    if (answer.code.value < 0)
      throw std::runtime_error(answer.code.name + ": " + answer.code.message + " " + answer.code.hint);
  }

  ros::ServiceClient get_best_grasp_;
  ros::ServiceClient report_pick_;
  ros::ServiceClient clear_avoid_list_;
  ros::ServiceClient grip_;
  ros::ServiceClient shake_;
  bin_picking_ros::KinematicArm arm_;
  const std::string frame_;
  const int max_fruitless_;
  const ros::WallTime start_ = ros::WallTime::now();
  bool has_started_ = false;
  int num_attempts_ = 0;
  int num_picked_ = 0;
  std::optional<unsigned> num_left_;   ///< as the gripper told at the last attempt
  std::map<std::string, int> causes_;  ///< of what was not a pick
};
}  // namespace

int main(int argc, char** argv)
{
  ros::init(argc, argv, "ur5e_picker");
  ros::AsyncSpinner spinner(1);
  spinner.start();
  try
  {
    Picker picker(ros::NodeHandle(), ros::NodeHandle("~"));
    const bool is_empty = picker.run();
    picker.printSummary();
    return is_empty ? 0 : 1;
  }
  catch (const std::exception& error)
  {
    std::printf("ur5e_picker: %s\n", error.what());
    return 1;
  }
}
