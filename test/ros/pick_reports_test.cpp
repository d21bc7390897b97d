// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// What a robot reports of its attempts, and what that does to the next answer.
#include <bin_picking_perception/ReportPick.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <future>
#include <set>
#include <thread>

#include "bin_picking_perception/common/error.hpp"
#include "detector_node_fixture.hpp"

namespace
{
using namespace bin_picking_ros;
using bin_picking_perception::ReportPick;

class PickReportsTest : public DetectorNodeTest
{
protected:
  void TearDown() override
  {
    camera_->stop();
    std_srvs::Trigger clear;
    EXPECT_TRUE(ros::service::call("/cell/detector/clear_avoid_list", clear));
  }

  static ReportPick::Response report(const std::string& uid, std::uint8_t outcome)
  {
    ReportPick call;
    call.request.grasp_uid = uid;
    call.request.outcome = outcome;
    call.request.note = "from the test";
    EXPECT_TRUE(ros::service::call("/cell/detector/report_pick", call)) << "the call itself failed";
    EXPECT_FALSE(call.response.code.name.empty());
    EXPECT_FALSE(call.response.code.message.empty());
    return call.response;
  }

  /// An answer, whatever its code.
  static GetBestGrasp::Response look(bool list_rejected = false)
  {
    GetBestGrasp call;
    call.request.list_rejected = list_rejected;
    EXPECT_TRUE(client_->call(call));
    return call.response;
  }
};

TEST_F(PickReportsTest, GraspsHaveNamesOfTheirOwn)
{
  camera_->start(makeMessage(scene_->grid));
  std::set<std::string> names;
  std::size_t num_grasps = 0;
  for (int i = 0; i < 3; ++i)
    for (const auto& grasp : ask().grasps)
    {
      names.insert(grasp.uid);
      ++num_grasps;
      EXPECT_LT(grasp.uid.size(), 20u);
      EXPECT_EQ(grasp.gripper, "ag95");
    }
  EXPECT_GE(num_grasps, 3u);
  EXPECT_EQ(names.size(), num_grasps);
  EXPECT_EQ(names.count(""), 0u);
}

TEST_F(PickReportsTest, TheOnlyPartIsAvoidedAfterAMissUntilTheListIsCleared)
{
  camera_->start(makeMessage(scene_->grid));
  const auto first = ask();
  ASSERT_FALSE(first.grasps.empty());
  const auto noted = report(first.grasps[0].uid, ReportPick::Request::MISSED);
  EXPECT_EQ(noted.code.value, ReturnCode::OK);
  EXPECT_EQ(noted.num_avoided, 1u);

  const auto second = look(true);
  EXPECT_EQ(second.code.value, ReturnCode::ALL_AVOIDED) << second.code.message;
  EXPECT_FALSE(second.code.hint.empty());
  EXPECT_TRUE(second.grasps.empty());
  EXPECT_TRUE(second.detections.at(0).accepted) << "it is found as before, only not offered";
  EXPECT_NE(second.summary.find("avoided"), std::string::npos) << second.summary;
  ASSERT_EQ(second.rejected_grasps.size(), first.grasps.size());
  EXPECT_NE(second.rejected_grasps[0].rejection.find("missed"), std::string::npos)
      << second.rejected_grasps[0].rejection;

  std_srvs::Trigger clear;
  ASSERT_TRUE(ros::service::call("/cell/detector/clear_avoid_list", clear));
  EXPECT_EQ(clear.response.message, "1 place was forgotten.");
  EXPECT_EQ(look().code.value, ReturnCode::OK);
}

TEST_F(PickReportsTest, APickClearsWhatWasAvoidedThere)
{
  camera_->start(makeMessage(scene_->grid));
  const auto first = ask();
  const auto second = ask();
  ASSERT_TRUE(!first.grasps.empty() && !second.grasps.empty());
  EXPECT_EQ(report(first.grasps[0].uid, ReportPick::Request::COLLISION).num_avoided, 1u);
  EXPECT_EQ(look().code.value, ReturnCode::ALL_AVOIDED);
  EXPECT_EQ(report(second.grasps[0].uid, ReportPick::Request::PICKED).num_avoided, 0u);
  EXPECT_EQ(look().code.value, ReturnCode::OK);
}

TEST_F(PickReportsTest, ReportsThatMakeNoSense)
{
  camera_->start(makeMessage(scene_->grid));
  const auto answer = ask();
  ASSERT_FALSE(answer.grasps.empty());
  const std::string uid = answer.grasps[0].uid;
  const auto unknown = report("no such grasp", ReportPick::Request::MISSED);
  EXPECT_EQ(unknown.code.value, ReturnCode::GRASP_UNKNOWN);
  EXPECT_FALSE(unknown.code.hint.empty());
  EXPECT_EQ(report("", ReportPick::Request::MISSED).code.value, ReturnCode::GRASP_UNKNOWN);
  EXPECT_EQ(report(uid, 99).code.value, ReturnCode::INVALID_ARGUMENT);
  EXPECT_EQ(look().code.value, ReturnCode::OK) << "nothing of this is avoided";
  EXPECT_EQ(report(uid, ReportPick::Request::NOT_ATTEMPTED).code.value, ReturnCode::OK);
  const auto twice = report(uid, ReportPick::Request::PICKED);
  EXPECT_EQ(twice.code.value, ReturnCode::GRASP_UNKNOWN);
  EXPECT_EQ(twice.num_avoided, 1u);
}

TEST_F(PickReportsTest, ExpiredGraspsAreUnknown)
{
  camera_->start(makeMessage(scene_->grid));
  const auto first = ask();
  ASSERT_FALSE(first.grasps.empty());
  for (int i = 0; i < 4; ++i)  // remembered_answers
    ask();
  EXPECT_EQ(report(first.grasps[0].uid, ReportPick::Request::PICKED).code.value, ReturnCode::GRASP_UNKNOWN);
}

TEST_F(PickReportsTest, AReportDoesNotWaitForARequestThatWaits)
{
  camera_->start(makeMessage(scene_->grid));
  const auto answer = ask();
  ASSERT_FALSE(answer.grasps.empty());
  camera_->stop();
  std::vector<std::future<std::int16_t>> waiting;
  for (unsigned i = 0; i < DetectorNode::SERVICE_THREADS; ++i)  // for a cloud that does not come
    waiting.push_back(std::async(std::launch::async, [] {
      GetBestGrasp call;
      EXPECT_TRUE(ros::service::call("/cell/detector/get_best_grasp", call));
      return call.response.code.value;
    }));
  std::this_thread::sleep_for(std::chrono::seconds(1));  // until all threads of the service are busy with them
  EXPECT_EQ(report(answer.grasps[0].uid, ReportPick::Request::PICKED).code.value, ReturnCode::OK);
  for (auto& call : waiting)
    EXPECT_EQ(call.wait_for(std::chrono::seconds(0)), std::future_status::timeout) << "it was answered without a cloud";
  camera_->start(makeMessage(scene_->grid));
  for (auto& call : waiting)
    EXPECT_EQ(call.get(), ReturnCode::OK);
}

TEST_F(PickReportsTest, GrippersByName)
{
  camera_->start(makeMessage(scene_->grid));
  GetBestGrasp::Request request;
  request.gripper = "wide_hand";
  const auto answer = ask(request);
  ASSERT_EQ(answer.code.value, ReturnCode::OK) << answer.code.message;
  EXPECT_EQ(answer.grasps[0].gripper, "wide_hand");
  // The same grasp by another hand: the tips where they were, the flange elsewhere.
  const auto other = ask();
  const Pose T_tip_tool0 = fromMessage(answer.grasps[0].grasp).inverse() * fromMessage(answer.grasps[0].grasp_tool0);
  EXPECT_NEAR(T_tip_tool0.translation().z(), -0.15, 1e-9);
  EXPECT_EQ(other.grasps[0].gripper, "ag95");

  request.gripper = "wide_hnad";
  const auto unknown = ask(request);
  EXPECT_EQ(unknown.code.value, ReturnCode::GRIPPER_UNKNOWN);
  EXPECT_NE(unknown.code.message.find("did you mean wide_hand?"), std::string::npos) << unknown.code.message;
  EXPECT_NE(unknown.code.message.find("ag95"), std::string::npos) << unknown.code.message;
}

TEST_F(PickReportsTest, WrongGrippersAreRefusedAtTheStart)
{
  ros::NodeHandle nh("other");
  ros::NodeHandle private_nh("other/detector");
  setParameters(private_nh);
  const std::string hand = std::string(BIN_PICKING_SOURCE_DIR) + "/test/ros/wide_hand.yaml";
  private_nh.setParam("grippers", std::vector<std::string>{"/no/such/gripper.yaml"});
  EXPECT_THROW(DetectorNode(nh, private_nh), bin_picking::Error);
  const std::string copy = cache_ + "_hand.yaml";
  boost::filesystem::copy_file(hand, copy);
  private_nh.setParam("grippers", std::vector<std::string>{hand, copy});
  EXPECT_THROW(DetectorNode(nh, private_nh), bin_picking::ParameterError) << "two of one name";
  boost::filesystem::remove(copy);
  private_nh.setParam("grippers", std::vector<std::string>{hand, hand});
  EXPECT_NO_THROW(DetectorNode(nh, private_nh)) << "one file twice is one gripper";
}
}  // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "pick_reports_test");
  ros::NodeHandle nh;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
