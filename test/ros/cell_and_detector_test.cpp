// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// The detector finds what lies in the virtual cell, without being told where.
#include <bin_picking_perception/GetBestGrasp.h>

#include <algorithm>

#include "bin_picking_perception/evaluation/pose_error.hpp"
#include "bin_picking_perception/model/part.hpp"
#include "cell_under_test.hpp"
#include "pose_conversion.hpp"
#include "return_code.hpp"

namespace
{
using namespace bin_picking_ros;
using bin_picking_perception::GetBestGrasp;

/// The service's answer once the models are trained and the bin is full.
GetBestGrasp::Response ask()
{
  GetBestGrasp call;
  EXPECT_TRUE(ros::service::waitForService("detector/get_best_grasp", ros::Duration(120)));
  const auto end = std::chrono::steady_clock::now() + CELL_PATIENCE;
  const auto is_early = [&call] {
    return call.response.code.value == ReturnCode::NOT_READY || call.response.code.value == ReturnCode::NO_CLOUD;
  };
  bool answered = false;  // on a loaded machine a connection made while the manager starts may be lost
  while ((!answered || is_early()) && std::chrono::steady_clock::now() < end)
  {
    answered = ros::service::call("detector/get_best_grasp", call);
    if (!answered)
      ros::WallDuration(0.1).sleep();
  }
  EXPECT_TRUE(answered) << "the service never answered";
  return call.response;
}

/// Names of the nodes that subscribe to a topic, as the master knows them.
std::vector<std::string> subscribersOf(const std::string& topic)
{
  XmlRpc::XmlRpcValue request, response, payload;
  request[0] = ros::this_node::getName();
  EXPECT_TRUE(ros::master::execute("getSystemState", request, response, payload, true));
  std::vector<std::string> nodes;
  XmlRpc::XmlRpcValue& subscriptions = payload[1];
  for (int i = 0; i < subscriptions.size(); ++i)
    if (static_cast<std::string>(subscriptions[i][0]) == topic)
      for (int k = 0; k < subscriptions[i][1].size(); ++k)
        nodes.push_back(subscriptions[i][1][k]);
  return nodes;
}

TEST(CellAndDetector, FoundPartsAreTrueAndTheTruthIsNotOverheard)
{
  ros::NodeHandle nh;
  ExposureCollector collector(nh, ros::NodeHandle("virtual_cell"));
  const GetBestGrasp::Response response = ask();
  ASSERT_TRUE(response.code.value == ReturnCode::OK || response.code.value == ReturnCode::NO_PICKABLE)
      << response.code.name << ": " << response.code.message;
  ASSERT_EQ(response.header.frame_id, "camera");  // no output frame was asked for
  const Exposure exposure = collector.since(response.header.stamp);
  ASSERT_TRUE(exposure.complete());
  ASSERT_EQ(exposure.truth->header.stamp, response.header.stamp);

  const auto tube = bin_picking::loadPart(std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/three_way_tube");
  std::size_t num_accepted = 0;
  for (const auto& detection : response.detections)
  {
    if (!detection.accepted)
      continue;
    ++num_accepted;
    double translation = 1;
    double rotation = M_PI;
    for (const auto& instance : exposure.truth->instances)
    {
      const auto error = bin_picking::poseError(fromMessage(detection.pose), fromMessage(instance.pose), tube.symmetry);
      if (error.translation < translation)
      {
        translation = error.translation;
        rotation = error.rotation;
      }
    }
    // A third of a column of the block and a tenth of the angle that would mistake a step for the next: picking is
    // safe.
    EXPECT_LT(translation, 0.003) << "detection " << detection.index;
    EXPECT_LT(rotation, 4 * M_PI / 180) << "detection " << detection.index;
  }
  EXPECT_GE(num_accepted, 3u) << "of 6 parts, hardly any of which another one hides";

  const std::vector<std::string> listeners = subscribersOf(ros::names::resolve("virtual_cell/truth"));
  EXPECT_EQ(listeners, std::vector<std::string>{ros::this_node::getName()});
}

TEST(CellAndDetector, PartThatWasFoundCanBeTaken)
{
  const GetBestGrasp::Response response = ask();
  const auto best = std::find_if(response.detections.begin(), response.detections.end(),
                                 [](const auto& detection) { return detection.accepted; });
  ASSERT_NE(best, response.detections.end()) << response.code.message;
  TakePart call;
  call.request.select = TakePart::Request::BY_POSE;
  call.request.pose.header = best->header;
  call.request.pose.pose = best->pose;
  call.request.part = best->part;
  ASSERT_TRUE(ros::service::call("virtual_cell/take_part", call));
  EXPECT_EQ(call.response.outcome, TakePart::Response::TAKEN) << call.response.message;
  EXPECT_EQ(call.response.num_left, 5u);
}
}  // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "cell_and_detector_test");
  ros::NodeHandle nh;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
