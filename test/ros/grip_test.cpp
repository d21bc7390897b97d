// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// The virtual gripper: every outcome of ~grip. What the judge behind it knows is tested in
// test/core/grip_trial_test.cpp.
#include <tf2_ros/static_transform_broadcaster.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bin_picking_perception/grasping/gripper.hpp"
#include "bin_picking_perception/scene/bin.hpp"
#include "cell_under_test.hpp"
#include "pose_conversion.hpp"

namespace
{
using namespace bin_picking_ros;
using bin_picking::Pose;
using Request = Grip::Request;
using Response = Grip::Response;

const std::string SOURCE_DIR = BIN_PICKING_SOURCE_DIR;
const std::string GRIPPER = SOURCE_DIR + "/config/grippers/parallel_80mm.yaml";

/// One cube of 30 mm on the floor of a bin so wide that no wall is near.
std::map<std::string, XmlRpc::XmlRpcValue> oneCube(std::map<std::string, XmlRpc::XmlRpcValue> more = {})
{
  more.insert({{"parts", SOURCE_DIR + "/test/ros/cube"}, {"counts", 1}, {"gripper", GRIPPER}});
  more.insert({{"layout/bin_length", 0.8}, {"layout/bin_width", 0.8}});
  return more;
}

Pose binInCamera() { return bin_picking::loadBin(SOURCE_DIR + "/config/bins/virtual_cell.yaml").T_camera_bin; }

/// Straight down on the middle of a part, the fingers on two of its sides; moved aside by `aside` along the closing.
Request fromAbove(const Pose& T_camera_object, double aside = 0, const Pose& T_frame_camera = Pose::Identity(),
                  const std::string& frame = "camera")
{
  const Pose T_bin_object = binInCamera().inverse() * T_camera_object;
  Eigen::Index flattest = 0;
  T_bin_object.linear().row(2).cwiseAbs().minCoeff(&flattest);
  const Eigen::Vector3d side = T_bin_object.linear().col(flattest);
  const Eigen::Vector3d closing = Eigen::Vector3d(side.x(), side.y(), 0).normalized();
  Pose T_bin_tip = Pose::Identity();
  T_bin_tip.linear().col(1) = closing;
  T_bin_tip.linear().col(2) = -Eigen::Vector3d::UnitZ();
  T_bin_tip.linear().col(0) = closing.cross(-Eigen::Vector3d::UnitZ());
  T_bin_tip.translation() = T_bin_object.translation() + aside * closing;
  const Pose T_tip_tool0 = bin_picking::loadGripper(GRIPPER).T_tool0_tip(0.03).inverse();
  Request request;
  const auto assign = [&](geometry_msgs::PoseStamped& message, double height) {
    message.header.frame_id = frame;
    message.pose =
        toPoseMessage(T_frame_camera * binInCamera() * Eigen::Translation3d(0, 0, height) * T_bin_tip * T_tip_tool0);
  };
  assign(request.pre_grasp, 0.08);
  assign(request.grasp, 0);
  assign(request.retreat, 0.12);
  request.opening = 0.05;
  request.width = 0.03;
  return request;
}

Pose onlyPart(CellUnderTest& cell) { return fromMessage(cell.expose().truth->instances.at(0).pose); }

TEST(Grip, TakesThePartBetweenTheFingers)
{
  CellUnderTest cell("take", oneCube());
  const SceneTruth truth = *cell.expose().truth;
  Request request = fromAbove(fromMessage(truth.instances[0].pose));
  request.part = "cube";
  request.part_pose.header.frame_id = "camera";
  request.part_pose.pose = truth.instances[0].pose;
  const Response response = cell.grip(request);
  EXPECT_EQ(response.outcome, Response::TAKEN) << response.what;
  EXPECT_EQ(response.id, truth.instances[0].id);
  EXPECT_EQ(response.part, "cube");
  EXPECT_EQ(response.num_left, 0u);
  EXPECT_NEAR(response.final_opening, 0.03, 5e-4);
  EXPECT_LT(std::abs(response.offset), 5e-4);
  EXPECT_TRUE(cell.expose().truth->instances.empty());
  EXPECT_EQ(cell.grip(request).outcome, Response::MISSED) << "it is gone";
}

TEST(Grip, TransformsThePoses)
{
  CellUnderTest cell("transform", oneCube());
  Pose T_base_camera = Pose::Identity();
  T_base_camera.linear() = Eigen::AngleAxisd(2.5, Eigen::Vector3d(3, 1, 2).normalized()).toRotationMatrix();
  T_base_camera.translation() = Eigen::Vector3d(0.5, 0.1, 0.9);
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = "base";
  transform.header.stamp = ros::Time::now();
  transform.child_frame_id = "camera";
  transform.transform = toTransformMessage(T_base_camera);
  tf2_ros::StaticTransformBroadcaster broadcaster;
  broadcaster.sendTransform(transform);
  const Request request = fromAbove(onlyPart(cell), 0, T_base_camera, "base");
  Response response;
  const auto end = std::chrono::steady_clock::now() + CELL_PATIENCE;
  do
    response = cell.grip(request);
  while (response.outcome == Response::INVALID_REQUEST && std::chrono::steady_clock::now() < end);  // tf is on its way
  EXPECT_EQ(response.outcome, Response::TAKEN) << response.what;
}

TEST(Grip, TellsWhatItTouches)
{
  CellUnderTest cell("touch", oneCube());
  const SceneTruth before = *cell.expose().truth;
  const Response hit = cell.grip(fromAbove(fromMessage(before.instances.at(0).pose), 0.018));
  EXPECT_EQ(hit.outcome, Response::COLLISION) << hit.what;
  EXPECT_NE(hit.what.find("(cube)"), std::string::npos) << hit.what;
  EXPECT_NE(hit.what.find("before the grasp"), std::string::npos) << hit.what;
  EXPECT_EQ(hit.num_left, 1u);
  const Response beside = cell.grip(fromAbove(fromMessage(before.instances[0].pose), 0.06));
  EXPECT_EQ(beside.outcome, Response::MISSED) << beside.what;
  EXPECT_EQ(beside.id, -1);
  EXPECT_EQ(cell.expose().truth->instances.at(0).pose, before.instances[0].pose) << "nothing moved";
}

TEST(Grip, MissesAndLosesByChance)
{
  CellUnderTest unlucky("unlucky", oneCube({{"failure_probability", 1}}));
  const Response missed = unlucky.grip(fromAbove(onlyPart(unlucky)));
  EXPECT_EQ(missed.outcome, Response::MISSED) << missed.what;
  EXPECT_NE(missed.what.find("chance"), std::string::npos) << missed.what;
  CellUnderTest slippery("slippery", oneCube({{"drop_probability", 1}}));
  const Pose before = onlyPart(slippery);
  EXPECT_EQ(slippery.grip(fromAbove(before)).outcome, Response::DROPPED_BACK);
  EXPECT_FALSE(onlyPart(slippery).isApprox(before, 1e-6));
}

TEST(Grip, RefusesRequestsWithoutSense)
{
  CellUnderTest cell("refuse", oneCube({{"tf_timeout", 0}}));
  const Request good = fromAbove(onlyPart(cell));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::pair<Request, std::string>> wrong(11, {good, ""});
  wrong[0].first.grasp.pose.position.x = nan;
  wrong[0].second = "not finite";
  wrong[1].first.pre_grasp.pose.orientation = geometry_msgs::Quaternion();  // forgotten
  wrong[1].second = "quaternion";
  wrong[2].first.retreat.pose.orientation.w *= 2;
  wrong[2].first.retreat.pose.orientation.x *= 2;
  wrong[2].first.retreat.pose.orientation.y *= 2;
  wrong[2].first.retreat.pose.orientation.z *= 2;
  wrong[2].second = "length 2";
  wrong[3].first.grasp.header.frame_id = "no_such_frame";
  wrong[3].second = "no_such_frame";
  wrong[4].first.grasp.header.frame_id = "";
  wrong[4].second = "frame_id";
  wrong[5].first.opening = 0.081;
  wrong[5].second = "80.0 mm";
  wrong[6].first.width = 0.06;
  wrong[6].second = "less than its opening";
  wrong[7].first.opening = nan;
  wrong[7].second = "finite";
  wrong[8].first.retreat.pose = good.part_pose.pose;
  wrong[8].first.retreat.pose.orientation.w = 1;
  wrong[8].second = "retreat is turned";
  wrong[9].first.part = "teapot";
  wrong[9].second = "teapot";
  wrong[10].first.part_pose.header.frame_id = "camera";  // with a forgotten orientation
  wrong[10].second = "quaternion";
  for (std::size_t i = 0; i < wrong.size(); ++i)
  {
    const Response response = cell.grip(wrong[i].first);
    EXPECT_EQ(response.outcome, Response::INVALID_REQUEST) << i << ": " << response.what;
    EXPECT_NE(response.what.find(wrong[i].second), std::string::npos) << i << ": " << response.what;
    EXPECT_EQ(response.id, -1);
  }
  EXPECT_EQ(cell.grip(good).outcome, Response::TAKEN);
}

TEST(Grip, NeedsAGripper)
{
  CellUnderTest bare("bare", oneCube({{"gripper", ""}}));
  const Response response = bare.grip(fromAbove(onlyPart(bare)));
  EXPECT_EQ(response.outcome, Response::INVALID_REQUEST);
  EXPECT_NE(response.what.find("parameter gripper"), std::string::npos) << response.what;
  CellUnderTest wrong("wrong", oneCube({{"gripper", SOURCE_DIR + "/no_such_gripper.yaml"}}));
  EXPECT_NE(wrong.failure().find("no_such_gripper.yaml"), std::string::npos) << wrong.failure();
  EXPECT_EQ(wrong.grip({}).outcome, Response::FAILED);
}
}  // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "grip_test");
  ros::NodeHandle nh;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
