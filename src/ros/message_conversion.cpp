// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "message_conversion.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "pose_conversion.hpp"

namespace bin_picking_ros
{
namespace msgs = bin_picking_perception;

namespace
{
msgs::Criterion toMessage(const bin_picking::Criterion& criterion)
{
  msgs::Criterion message;
  message.name = criterion.name;
  message.value = criterion.value;
  message.required = criterion.required;
  message.upper_limit = criterion.upper_limit;
  message.passed = criterion.passed();
  return message;
}

void setTurn(const bin_picking::UndeterminedTurn& turn, msgs::Detection& message)
{
  message.undetermined_turn = true;
  message.turn = bin_picking::describe(turn);
  message.turn_origin.x = turn.axis.origin.x();
  message.turn_origin.y = turn.axis.origin.y();
  message.turn_origin.z = turn.axis.origin.z();
  message.turn_axis.x = turn.axis.direction.x();
  message.turn_axis.y = turn.axis.direction.y();
  message.turn_axis.z = turn.axis.direction.z();
  message.turn_angles = turn.angles;
}

msgs::Detection toMessage(const bin_picking::Detection& detection, const OutputFrame& output)
{
  msgs::Detection message;
  message.header = output.header;
  message.part = detection.part;
  message.pose = toPoseMessage(output.T_output_camera * detection.T_camera_object);
  message.score = detection.score;
  message.matching_rate = detection.matching_rate;
  message.visible_fraction = detection.visible_fraction;
  message.rms = detection.rms;
  message.votes = detection.votes;
  message.accepted = detection.rejection.empty();
  message.rejection = detection.rejection;
  for (const bin_picking::Criterion& criterion : detection.criteria)
    message.criteria.push_back(toMessage(criterion));
  if (detection.undetermined_turn)
    setTurn(*detection.undetermined_turn, message);
  return message;
}

/// Of a grasp that the gripper cannot make, there is no pose of the flange.
geometry_msgs::Pose poseOrNan(const bin_picking::Pose& pose)
{
  if (pose.matrix().allFinite())
    return toPoseMessage(pose);
  geometry_msgs::Pose message;
  message.position.x = message.position.y = message.position.z = std::numeric_limits<double>::quiet_NaN();
  message.orientation.x = message.orientation.y = message.orientation.z = message.orientation.w = message.position.x;
  return message;
}

/// What nobody looked at is marked as such, never filled with a value that could pass for a result.
void setClearance(const bin_picking::Grasp& grasp, const OutputFrame& output, msgs::Grasp& message)
{
  const bin_picking::Clearance& closest = grasp.clearance;
  message.collision_checked = grasp.collision_checked;
  message.clearance = grasp.collision_checked ? closest.distance : std::numeric_limits<double>::quiet_NaN();
  message.required_clearance = closest.required;
  if (closest.kind != bin_picking::ObstacleKind::None)
    message.clearance_to = closest.body + " to " + closest.obstacle;
  const Eigen::Vector3d contact = output.T_output_camera * closest.contact_camera;
  message.contact.x = contact.x();
  message.contact.y = contact.y();
  message.contact.z = contact.z();
}

void setJoints(const bin_picking::Grasp& grasp, msgs::Grasp& message)
{
  message.reach_checked = grasp.reach_checked;
  if (grasp.joints.size() != 3)
    return;
  std::vector<double>* const lists[] = {&message.joints_pre_grasp, &message.joints_grasp, &message.joints_retreat};
  for (std::size_t i = 0; i < 3; ++i)
    lists[i]->assign(grasp.joints[i].data(), grasp.joints[i].data() + grasp.joints[i].size());
}

msgs::Grasp toMessage(const bin_picking::Grasp& grasp, const std::string& gripper, const OutputFrame& output)
{
  msgs::Grasp message;
  message.header = output.header;
  message.uid = grasp.uid;
  message.gripper = gripper;
  message.part = grasp.part;
  message.grasp_id = grasp.grasp_id;
  message.detection_index = static_cast<std::uint32_t>(grasp.detection_index);
  message.symmetry_variant = static_cast<std::uint32_t>(grasp.symmetry_variant);
  message.pre_grasp = toPoseMessage(output.T_output_camera * grasp.tip.pre_grasp);
  message.grasp = toPoseMessage(output.T_output_camera * grasp.tip.grasp);
  message.retreat = toPoseMessage(output.T_output_camera * grasp.tip.retreat);
  message.pre_grasp_tool0 = poseOrNan(output.T_output_camera * grasp.tool0.pre_grasp);
  message.grasp_tool0 = poseOrNan(output.T_output_camera * grasp.tool0.grasp);
  message.retreat_tool0 = poseOrNan(output.T_output_camera * grasp.tool0.retreat);
  message.object_in_tip = toPoseMessage(grasp.T_tip_object);
  message.undetermined_turn = grasp.undetermined_turn;
  message.width = grasp.width;
  message.opening = grasp.opening;
  message.priority = grasp.priority;
  message.tilt = grasp.tilt;
  message.quality = grasp.quality;
  setClearance(grasp, output, message);
  setJoints(grasp, message);
  message.rejection = grasp.reason;
  return message;
}

/// Every rejected detection counts once, under the first criterion it failed.
std::string reasonOf(const bin_picking::Detection& detection)
{
  for (const bin_picking::Criterion& criterion : detection.criteria)
    if (!criterion.passed())
      return criterion.name;
  return "other";
}
}  // namespace

msgs::DetectionArray toDetectionArray(const PickResult& result, const OutputFrame& output)
{
  msgs::DetectionArray message;
  message.header = output.header;
  message.code = result.code;
  for (const auto* list : {&result.detection.detections, &result.detection.rejected})
    for (const bin_picking::Detection& detection : *list)
    {
      message.detections.push_back(toMessage(detection, output));
      message.detections.back().index = static_cast<std::uint32_t>(message.detections.size() - 1);
    }
  return message;
}

msgs::GraspArray toGraspArray(const PickResult& result, const OutputFrame& output)
{
  msgs::GraspArray message;
  message.header = output.header;
  for (const bin_picking::Grasp& grasp : result.selection.grasps)
    message.grasps.push_back(toMessage(grasp, result.gripper, output));
  return message;
}

geometry_msgs::PoseArray toPoseArray(const PickResult& result, const OutputFrame& output)
{
  geometry_msgs::PoseArray message;
  message.header = output.header;
  for (const bin_picking::Detection& detection : result.detection.detections)
    message.poses.push_back(toPoseMessage(output.T_output_camera * detection.T_camera_object));
  return message;
}

std::vector<msgs::RejectCount> countRejections(const PickResult& result)
{
  std::map<std::pair<std::string, std::string>, std::uint32_t> counts;
  for (const bin_picking::Detection& detection : result.detection.rejected)
    ++counts[{"detection", reasonOf(detection)}];
  for (const bin_picking::Grasp& grasp : result.selection.rejected)
    ++counts[{"grasp", bin_picking::toString(grasp.rejection)}];

  std::vector<msgs::RejectCount> messages;
  for (const auto& [key, count] : counts)
  {
    messages.emplace_back();
    messages.back().kind = key.first;
    messages.back().reason = key.second;
    messages.back().count = count;
  }
  std::stable_sort(messages.begin(), messages.end(),
                   [](const msgs::RejectCount& a, const msgs::RejectCount& b) { return a.count > b.count; });
  return messages;
}

std::string inWords(bin_picking::GraspRejection rejection)
{
  std::string words = bin_picking::toString(rejection);
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string summarize(const bin_picking::GraspSelection& selection)
{
  std::map<bin_picking::GraspRejection, std::size_t> counts;
  for (const bin_picking::Grasp& grasp : selection.rejected)
    ++counts[grasp.rejection];
  std::vector<std::pair<std::string, std::size_t>> reasons;
  for (const auto& [rejection, count] : counts)
    reasons.emplace_back(inWords(rejection), count);
  std::stable_sort(reasons.begin(), reasons.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  if (!selection.grasps.empty())
    reasons.insert(reasons.begin(), {"allowed", selection.grasps.size()});

  const std::size_t total = selection.grasps.size() + selection.rejected.size();
  std::string text = std::to_string(total) + (total == 1 ? " grasp" : " grasps");
  const char* separator = ": ";
  for (const auto& [reason, count] : reasons)
  {
    text += separator + std::to_string(count) + " " + reason;
    separator = ", ";
  }
  return text;
}

msgs::GetBestGrasp::Response toResponse(const PickResult& result, const OutputFrame& output, bool list_rejected)
{
  msgs::GetBestGrasp::Response response;
  response.code = result.code;
  response.header = output.header;
  response.grasps = toGraspArray(result, output).grasps;
  response.detections = toDetectionArray(result, output).detections;
  if (list_rejected)
    for (const bin_picking::Grasp& grasp : result.selection.rejected)
      response.rejected_grasps.push_back(toMessage(grasp, result.gripper, output));
  response.summary = summarize(result.selection);
  response.rejected = countRejections(result);
  for (const bin_picking::StageTime& time : result.detection.timing)
  {
    response.timing.emplace_back();
    response.timing.back().stage = time.stage;
    response.timing.back().seconds = time.seconds;
  }
  response.timing.emplace_back();
  response.timing.back().stage = "total";
  response.timing.back().seconds = result.detection.total_seconds;
  return response;
}
}  // namespace bin_picking_ros
