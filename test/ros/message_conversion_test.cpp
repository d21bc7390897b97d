// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "message_conversion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/evaluation/detection_picture.hpp"
#include "marker_primitives.hpp"
#include "markers.hpp"
#include "pose_conversion.hpp"
#include "segmentation_image.hpp"
#include "time_difference.hpp"

namespace
{
using namespace bin_picking_ros;
using bin_picking::Pose;

Pose makePose(double angle, const Eigen::Vector3d& axis, const Eigen::Vector3d& position)
{
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  pose.translation() = position;
  return pose;
}

/// Two accepted detections, one rejected, one grasp of the second, one rejected grasp.
PickResult someResult()
{
  PickResult result;
  result.code = makeReturnCode(ReturnCode::OK, "2 parts found.");
  for (int i = 0; i < 3; ++i)
  {
    bin_picking::Detection detection;
    detection.part = "block";
    detection.score = 0.9 - 0.1 * i;
    detection.T_camera_object = makePose(0.3 + i, {1, 2, 3}, {0.1 * i, 0.2, 0.8});
    detection.criteria = {{"matching_rate", 0.9 - 0.3 * i, 0.5, false}, {"violation_share", 0.1, 0.25, true}};
    (i < 2 ? result.detection.detections : result.detection.rejected).push_back(detection);
  }
  result.detection.rejected[0].rejection = "The matching rate is 0.3; at least 0.5 is needed.";
  result.detection.detections[1].undetermined_turn = {{Eigen::Vector3d::UnitZ(), {0.01, 0.02, 0}}, {1.5, 3}, 0.004};
  result.detection.timing = {{"segmentation", 0.01}, {"matching", 0.2}};
  result.detection.total_seconds = 0.21;
  bin_picking::Grasp grasp;
  grasp.part = "block";
  grasp.grasp_id = "top";
  grasp.detection_index = 1;
  grasp.undetermined_turn = true;
  grasp.tip.grasp = makePose(1.0, {0, 1, 0}, {0.1, 0.2, 0.75});
  grasp.tip.pre_grasp = grasp.tip.grasp * Eigen::Translation3d(0, 0, -0.08);
  // The flange stands 0.2 m behind the tips.
  const Eigen::Translation3d to_flange(0, 0, -0.2);
  grasp.tool0.grasp = grasp.tip.grasp * to_flange;
  grasp.tool0.pre_grasp = grasp.tip.pre_grasp * to_flange;
  grasp.tool0.retreat = grasp.tip.retreat * to_flange;
  grasp.opening = 0.05;
  grasp.width = 0.02;
  grasp.uid = "run-1-0";
  result.gripper = "hand";
  result.centers = {{0, 0.2, 0.8}, {0.1, 0.2, 0.8}};
  result.avoided = {{{0.1, 0.2, 0.8}, 0.02, 5, 65, 3, bin_picking::PickOutcome::Missed, "block"}};
  result.selection.grasps = {grasp};
  grasp.uid.clear();
  grasp.reason = "The approach is tilted.";
  grasp.rejection = bin_picking::GraspRejection::TiltTooLarge;
  result.selection.rejected = {grasp, grasp};
  grasp.rejection = bin_picking::GraspRejection::UndeterminedTurn;
  result.selection.rejected.push_back(grasp);
  result.bin = bin_picking::Bin();
  result.bin->inner_size = {0.4, 0.3, 0.1};
  return result;
}

OutputFrame someOutput()
{
  OutputFrame output;
  output.header.frame_id = "base_link";
  output.header.stamp = ros::Time(12, 34);
  output.T_output_camera = makePose(3.0, {1, 0.2, 0}, {0.5, 0, 0.9});
  return output;
}

TEST(PoseConversion, RoundTripKeepsThePose)
{
  for (const double angle : {0.0, 0.5, 3.1, 3.14159265, -2.0})
  {
    const Pose pose = makePose(angle, {0.2, -1, 0.7}, {1, -2, 3});
    const auto message = toPoseMessage(pose);
    EXPECT_TRUE(fromMessage(message).isApprox(pose, 1e-12));
    EXPECT_TRUE(fromMessage(toTransformMessage(pose)).isApprox(pose, 1e-12));
    EXPECT_GE(message.orientation.w, 0.0);
  }
}

TEST(PoseConversion, RefusesWhatIsNoPose)
{
  Pose pose = Pose::Identity();
  pose.translation().y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(toPoseMessage(pose), std::logic_error);
  geometry_msgs::Pose forgotten;  // all zero
  EXPECT_THROW(fromMessage(forgotten), RequestError);
  forgotten.orientation.w = 1.01;
  EXPECT_THROW(fromMessage(forgotten), RequestError);
  forgotten.orientation.w = 1.0;
  EXPECT_NO_THROW(fromMessage(forgotten));
  forgotten.position.x = std::numeric_limits<double>::infinity();
  EXPECT_THROW(fromMessage(forgotten), RequestError);
}

std::int16_t codeOf(const std::function<void()>& fail)
{
  try
  {
    fail();
  }
  catch (...)
  {
    const ReturnCode code = translateException(std::current_exception());
    EXPECT_FALSE(code.name.empty());
    EXPECT_FALSE(code.message.empty());
    EXPECT_FALSE(code.hint.empty());
    return code.value;
  }
  return 0;
}

TEST(ReturnCodes, ExceptionsBecomeCodes)
{
  using bin_picking::CloudError;
  using bin_picking::CloudFault;
  EXPECT_EQ(codeOf([] { throw RequestError(ReturnCode::NO_CLOUD, "none"); }), ReturnCode::NO_CLOUD);
  EXPECT_EQ(codeOf([] { throw CloudError(CloudFault::UnitSuspect, "mm"); }), ReturnCode::UNIT_SUSPECT);
  for (const auto fault : {CloudFault::Empty, CloudFault::Unorganized, CloudFault::AllInvalid, CloudFault::BadLayout,
                           CloudFault::NoProjection})
    EXPECT_EQ(codeOf([fault] { throw CloudError(fault, "bad"); }), ReturnCode::BAD_CLOUD);
  EXPECT_EQ(codeOf([] { throw bin_picking::ParameterError("range"); }), ReturnCode::INVALID_ARGUMENT);
  EXPECT_EQ(codeOf([] { throw bin_picking::FileError("gone"); }), ReturnCode::INTERNAL);
  EXPECT_EQ(codeOf([] { throw std::bad_alloc(); }), ReturnCode::INTERNAL);
  EXPECT_EQ(codeOf([] { throw 5; }), ReturnCode::INTERNAL);
  EXPECT_THROW(makeReturnCode(-99, ""), std::logic_error);
}

TEST(MessageConversion, ResponseHoldsEverythingInTheOutputFrame)
{
  const PickResult result = someResult();
  const OutputFrame output = someOutput();
  const auto response = toResponse(result, output);
  EXPECT_EQ(response.header.frame_id, "base_link");
  ASSERT_EQ(response.detections.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
  {
    const auto& source = i < 2 ? result.detection.detections[i] : result.detection.rejected[0];
    EXPECT_EQ(response.detections[i].index, i);
    EXPECT_EQ(response.detections[i].accepted, i < 2);
    EXPECT_EQ(response.detections[i].rejection.empty(), i < 2);
    EXPECT_TRUE(
        fromMessage(response.detections[i].pose).isApprox(output.T_output_camera * source.T_camera_object, 1e-9));
    EXPECT_EQ(response.detections[i].header.stamp, ros::Time(12, 34));
    ASSERT_EQ(response.detections[i].criteria.size(), 2u);
    EXPECT_EQ(response.detections[i].criteria[0].passed, i < 2);
    EXPECT_TRUE(response.detections[i].criteria[1].passed);
  }
  ASSERT_EQ(response.grasps.size(), 1u);
  EXPECT_EQ(response.grasps[0].detection_index, 1u);
  // 80 mm back along the approach, in any frame
  const Pose T_grasp_pre = fromMessage(response.grasps[0].grasp).inverse() * fromMessage(response.grasps[0].pre_grasp);
  EXPECT_TRUE(T_grasp_pre.translation().isApprox(Eigen::Vector3d(0, 0, -0.08), 1e-9));
  ASSERT_EQ(response.rejected.size(), 3u);
  EXPECT_EQ(response.rejected[0].kind, "grasp");
  EXPECT_EQ(response.rejected[0].count, 2u);
  EXPECT_EQ(response.rejected[1].reason, "matching_rate");
  EXPECT_EQ(response.rejected[2].reason, "undetermined_turn");
  ASSERT_EQ(response.timing.size(), 3u);
  EXPECT_EQ(response.timing.back().stage, "total");
  EXPECT_DOUBLE_EQ(response.timing.back().seconds, 0.21);
  EXPECT_EQ(toPoseArray(result, output).poses.size(), 2u);
}

TEST(MessageConversion, AGraspTellsItsNameAndTheFlange)
{
  const auto response = toResponse(someResult(), someOutput());
  const auto& grasp = response.grasps.at(0);
  EXPECT_EQ(grasp.uid, "run-1-0");
  EXPECT_EQ(grasp.gripper, "hand");
  EXPECT_TRUE(grasp.rejection.empty());
  const Pose T_tip_tool0 = fromMessage(grasp.grasp).inverse() * fromMessage(grasp.grasp_tool0);
  EXPECT_TRUE(T_tip_tool0.translation().isApprox(Eigen::Vector3d(0, 0, -0.2), 1e-9));
  EXPECT_TRUE((fromMessage(grasp.pre_grasp) * T_tip_tool0).isApprox(fromMessage(grasp.pre_grasp_tool0), 1e-9));
  EXPECT_TRUE((fromMessage(grasp.retreat) * T_tip_tool0).isApprox(fromMessage(grasp.retreat_tool0), 1e-9));
}

TEST(MessageConversion, WhatNobodyLookedAtHasNoValue)
{
  const auto grasp = toResponse(someResult(), someOutput()).grasps.at(0);
  EXPECT_FALSE(grasp.collision_checked);
  EXPECT_TRUE(std::isnan(grasp.clearance));
  EXPECT_TRUE(grasp.clearance_to.empty());
  EXPECT_TRUE(std::isnan(grasp.contact.x));
  EXPECT_FALSE(grasp.reach_checked);
  EXPECT_TRUE(grasp.joints_grasp.empty());
}

TEST(MessageConversion, TheClosestPassageIsToldInTheOutputFrame)
{
  PickResult result = someResult();
  bin_picking::Grasp& grasp = result.selection.grasps[0];
  grasp.collision_checked = true;
  EXPECT_TRUE(std::isinf(toResponse(result, someOutput()).grasps[0].clearance)) << "nothing is near";
  grasp.clearance.distance = 0.004;
  grasp.clearance.required = 0.003;
  grasp.clearance.kind = bin_picking::ObstacleKind::BinWall;
  grasp.clearance.body = "finger_left";
  grasp.clearance.obstacle = "wall at +x";
  grasp.clearance.contact_camera = {0.1, 0.2, 0.7};
  const auto message = toResponse(result, someOutput()).grasps[0];
  EXPECT_TRUE(message.collision_checked);
  EXPECT_EQ(message.clearance, 0.004);
  EXPECT_EQ(message.required_clearance, 0.003);
  EXPECT_EQ(message.clearance_to, "finger_left to wall at +x");
  const Eigen::Vector3d contact = someOutput().T_output_camera * Eigen::Vector3d(0.1, 0.2, 0.7);
  EXPECT_NEAR(message.contact.x, contact.x(), 1e-12);
  EXPECT_NEAR(message.contact.y, contact.y(), 1e-12);
  EXPECT_NEAR(message.contact.z, contact.z(), 1e-12);
}

TEST(MessageConversion, RejectedGraspsOnRequestOnly)
{
  PickResult result = someResult();
  EXPECT_TRUE(toResponse(result, someOutput()).rejected_grasps.empty());
  // A grasp that the gripper cannot make has no pose of the flange: NaN, and no error.
  result.selection.rejected[0].tool0.grasp.translation().x() = std::numeric_limits<double>::quiet_NaN();
  const auto response = toResponse(result, someOutput(), true);
  ASSERT_EQ(response.rejected_grasps.size(), 3u);
  EXPECT_EQ(response.rejected_grasps[0].rejection, "The approach is tilted.");
  EXPECT_TRUE(response.rejected_grasps[0].uid.empty()) << "it was not offered, so that nobody can report it";
  EXPECT_TRUE(std::isnan(response.rejected_grasps[0].grasp_tool0.orientation.w));
  EXPECT_EQ(response.rejected_grasps[1].detection_index, 1u);
}

TEST(MessageConversion, SummaryCountsTheReasonsMostFrequentFirst)
{
  bin_picking::GraspSelection selection;
  EXPECT_EQ(summarize(selection), "0 grasps");
  const auto add = [&selection](bin_picking::GraspRejection rejection, int count) {
    bin_picking::Grasp grasp;
    grasp.rejection = rejection;
    selection.rejected.insert(selection.rejected.end(), static_cast<std::size_t>(count), grasp);
  };
  add(bin_picking::GraspRejection::TiltTooLarge, 3);
  add(bin_picking::GraspRejection::BinWallCollision, 9);
  add(bin_picking::GraspRejection::Avoided, 2);
  EXPECT_EQ(summarize(selection), "14 grasps: 9 bin wall collision, 3 tilt too large, 2 avoided");
  selection.grasps.resize(1);
  EXPECT_EQ(summarize(selection), "15 grasps: 1 allowed, 9 bin wall collision, 3 tilt too large, 2 avoided");
  selection.rejected.clear();
  EXPECT_EQ(summarize(selection), "1 grasp: 1 allowed");
}

TEST(MessageConversion, AnOpenTurnIsToldInThePartsFrame)
{
  const auto response = toResponse(someResult(), someOutput());
  EXPECT_FALSE(response.detections[0].undetermined_turn);
  EXPECT_TRUE(response.detections[0].turn.empty());
  const auto& open = response.detections[1];
  EXPECT_TRUE(open.undetermined_turn);
  EXPECT_EQ(open.turn.find("it may as well be turned by 86 or 172 deg about the axis z"), 0u) << open.turn;
  EXPECT_EQ(open.turn_axis.z, 1.0);
  EXPECT_EQ(open.turn_origin.x, 0.01);
  EXPECT_EQ(open.turn_origin.y, 0.02);
  EXPECT_EQ(open.turn_angles, (std::vector<double>{1.5, 3}));
  EXPECT_TRUE(response.grasps[0].undetermined_turn);
}

TEST(Markers, ShowEveryDetectionInItsColour)
{
  bin_picking::TrainedModel model;
  model.mesh.vertices = {{0, 0, 0}, {0.05f, 0, 0}, {0, 0.05f, 0}, {0, 0, 0.05f}};
  model.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  bin_picking::Gripper gripper;
  gripper.name = "hand";
  gripper.max_opening = 0.1;
  gripper.tip_heights = {{0.0, 0.2}};
  bin_picking::GripperBody palm;
  palm.shape = bin_picking::makeBox({0, 0, 0.1}, {0.1, 0.1, 0.05});
  bin_picking::GripperBody finger;
  finger.shape = bin_picking::makeBox({0, 0.01, 0.2}, {0.02, 0.02, 0.04});
  finger.placements = {{0, {0, 0, 0}, 0}, {0.1, {0, 0.05, 0}, 0}};
  gripper.bodies = {palm, finger};
  const MarkerMaker maker({std::make_shared<const bin_picking::TrainedModel>(model)}, GripperSet({gripper}));
  PickResult result = someResult();
  result.gripper = gripper.name;
  const auto markers = maker.make(result, someOutput()).markers;
  ASSERT_FALSE(markers.empty());
  EXPECT_EQ(markers.front().action, visualization_msgs::Marker::DELETEALL);

  std::map<std::string, int> count;
  std::set<std::pair<std::string, int>> names;
  for (std::size_t i = 1; i < markers.size(); ++i)
  {
    ++count[markers[i].ns];
    EXPECT_TRUE(names.insert({markers[i].ns, markers[i].id}).second) << "a name is used twice: " << markers[i].ns;
    EXPECT_EQ(markers[i].header.frame_id, "base_link");
    EXPECT_GT(markers[i].color.a, 0.0f);
    if (markers[i].ns == "parts")
    {
      EXPECT_EQ(markers[i].points.size(), 12u);
      EXPECT_EQ(markers[i].color.r, bin_picking::rankColor(static_cast<std::size_t>(markers[i].id)).x());
    }
    if (markers[i].ns == "labels")
    {
      EXPECT_EQ(markers[i].text, markers[i].id == 0 ? "0: 0.90" : "1: 0.80, turn open");
    }
    if (markers[i].ns == "rejected_grasp_labels")
    {
      EXPECT_EQ(markers[i].text, markers[i].id == 0 ? "tilt too large" : "undetermined turn");
    }
    if (markers[i].ns == "avoided")
    {
      EXPECT_EQ(markers[i].scale.x, 2 * 0.02);
      EXPECT_TRUE(fromMessage(markers[i].pose)
                      .translation()
                      .isApprox(someOutput().T_output_camera * Eigen::Vector3d(0.1, 0.2, 0.8), 1e-9));
    }
    if (markers[i].ns == "gripper" && markers[i].id == 1)
    {
      // The finger stands at its place for opening 0, moved by half the opening along Y of the tip frame.
      const Pose T_output_tip = someOutput().T_output_camera * result.selection.grasps[0].tip.grasp;
      ASSERT_EQ(markers[i].points.size(), 36u);  // twelve triangles
      const Pose T_tip_marker = T_output_tip.inverse() * fromMessage(markers[i].pose);
      for (const auto& p : markers[i].points)
      {
        const Eigen::Vector3d corner = T_tip_marker * Eigen::Vector3d(p.x, p.y, p.z) - Eigen::Vector3d(0, 0.035, 0);
        EXPECT_TRUE(corner.cwiseAbs().isApprox(Eigen::Vector3d(0.01, 0.01, 0.02), 1e-6)) << corner.transpose();
      }
    }
  }
  const std::map<std::string, int> expected = {
      {"parts", 2}, {"labels", 2},  {"rejected", 1},        {"bin", 1},     {"grasp", 1},
      {"path", 1},  {"gripper", 2}, {"rejected_grasps", 2}, {"avoided", 1}, {"rejected_grasp_labels", 2}};
  EXPECT_EQ(count, expected);
}

TEST(Markers, LargeMeshesAreSimplified)
{
  // A closed sphere of 2 x 100 x 200 triangles
  bin_picking::TriangleMesh mesh;
  constexpr std::uint32_t ROWS = 100;
  constexpr std::uint32_t COLUMNS = 200;
  for (std::uint32_t i = 0; i <= ROWS; ++i)
    for (std::uint32_t j = 0; j < COLUMNS; ++j)
    {
      const double a = M_PI * i / ROWS;
      const double b = 2 * M_PI * j / COLUMNS;
      mesh.vertices.push_back((0.05 * Eigen::Vector3d(sin(a) * cos(b), sin(a) * sin(b), cos(a))).cast<float>());
    }
  for (std::uint32_t i = 0; i < ROWS; ++i)
    for (std::uint32_t j = 0; j < COLUMNS; ++j)
    {
      const std::uint32_t next = (j + 1) % COLUMNS;
      mesh.triangles.push_back({i * COLUMNS + j, (i + 1) * COLUMNS + j, i * COLUMNS + next});
      mesh.triangles.push_back({i * COLUMNS + next, (i + 1) * COLUMNS + j, (i + 1) * COLUMNS + next});
    }
  const auto small = simplifyForDisplay(mesh, 3000);
  EXPECT_LT(small.triangles.size(), 3000u);
  EXPECT_GT(small.triangles.size(), 500u);
  double area = 0;
  for (const auto& t : small.triangles)
    area +=
        0.5 * (small.vertices[t[1]] - small.vertices[t[0]]).cross(small.vertices[t[2]] - small.vertices[t[0]]).norm();
  EXPECT_NEAR(area, 4 * M_PI * 0.05 * 0.05,
              0.1 * 4 * M_PI * 0.05 * 0.05);  // chords of cells of 6 mm lie inside the ball
  EXPECT_EQ(simplifyForDisplay(mesh, 40000).triangles.size(), mesh.triangles.size());
}

TEST(SegmentationImage, GrayWhereNothingIsColourWhereSegmentsAre)
{
  bin_picking::SegmentationView view;
  view.width = 3;
  view.height = 1;
  view.gray = {100, 100, 100};
  view.labels = {0, 1, 2};
  view.candidates = {0, 0, 2};
  const auto image = toImage(view, std_msgs::Header());
  ASSERT_EQ(image.data.size(), 9u);
  EXPECT_EQ(image.step, 9u);
  const auto spread = [&image](std::size_t pixel) {
    const auto [low, high] = std::minmax({image.data[3 * pixel], image.data[3 * pixel + 1], image.data[3 * pixel + 2]});
    return high - low;
  };
  EXPECT_EQ(spread(0), 0);
  EXPECT_EQ(image.data[0], 100);
  EXPECT_GT(spread(1), 20);
  EXPECT_GT(spread(2), 2 * spread(1));
}

TEST(TimeDifference, DoesNotThrowForStampsOfAFaultyDriver)
{
  const ros::Time now(1800000000, 500000000);
  const ros::Time garbage(4294967295u, 0);  // ros::Time's own difference of the two throws
  EXPECT_THROW(now - garbage, std::runtime_error);
  EXPECT_NEAR(secondsBetween(garbage, now), -2494967294.5, 1e-3);
  EXPECT_EQ(durationBetween(garbage, now).toSec(), -1e9);
  EXPECT_EQ(durationBetween(now, now + ros::Duration(0.25)).toSec(), 0.25);
}
}  // namespace
