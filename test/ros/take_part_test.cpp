// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// Taking parts out of the virtual bin: every outcome, and a bin that is emptied to the last part.
#include <tf2_ros/static_transform_broadcaster.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bin_picking_perception/scene/bin.hpp"
#include "cell_under_test.hpp"
#include "cloud_conversion.hpp"
#include "pose_conversion.hpp"

namespace
{
using namespace bin_picking_ros;
using bin_picking::Pose;
using bin_picking_perception::TrueInstance;
using Request = TakePart::Request;
using Response = TakePart::Response;

const TrueInstance* find(const SceneTruth& truth, int id)
{
  for (const TrueInstance& instance : truth.instances)
    if (instance.id == id)
      return &instance;
  return nullptr;
}

Request byPose(const std::string& frame, const geometry_msgs::Pose& pose)
{
  Request request;
  request.select = Request::BY_POSE;
  request.pose.header.frame_id = frame;
  request.pose.pose = pose;
  return request;
}

TEST(TakePart, TakesByIdAndByPose)
{
  CellUnderTest cell("take");
  const SceneTruth before = *cell.expose().truth;
  const Response taken = cell.takeId(before.instances[1].id);
  EXPECT_EQ(taken.outcome, Response::TAKEN) << taken.message;
  EXPECT_EQ(taken.id, before.instances[1].id);
  EXPECT_EQ(taken.part, "step_block");
  EXPECT_EQ(taken.num_left, 4u);
  const SceneTruth after = *cell.expose().truth;
  EXPECT_EQ(after.instances.size(), 4u);
  EXPECT_EQ(find(after, taken.id), nullptr);

  // The origin of the block's frame is a corner of its box: a pose turned about the block's middle is as good.
  const TrueInstance& wanted = after.instances.back();
  Request request = byPose("camera", wanted.pose);
  request.part = "step_block";
  const Response by_pose = cell.take(request);
  EXPECT_EQ(by_pose.outcome, Response::TAKEN) << by_pose.message;
  EXPECT_EQ(by_pose.id, wanted.id);
  EXPECT_EQ(by_pose.num_left, 3u);
  EXPECT_EQ(cell.takeId(wanted.id).outcome, Response::NO_SUCH_PART);
}

TEST(TakePart, TransformsThePose)
{
  CellUnderTest cell("transform");
  const SceneTruth truth = *cell.expose().truth;
  Pose T_hall_camera = Pose::Identity();
  T_hall_camera.linear() = Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  T_hall_camera.translation() = Eigen::Vector3d(4, -5, 6);
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = "hall";
  transform.header.stamp = ros::Time::now();
  transform.child_frame_id = "camera";
  transform.transform = toTransformMessage(T_hall_camera);
  tf2_ros::StaticTransformBroadcaster broadcaster;
  broadcaster.sendTransform(transform);
  const TrueInstance& wanted = truth.instances.front();
  Request request = byPose("hall", toPoseMessage(T_hall_camera * fromMessage(wanted.pose)));
  request.tolerance = 1e-4;  // the rounding of the quaternions, 6 m away, is much less
  Response response;
  const auto end = std::chrono::steady_clock::now() + CELL_PATIENCE;
  do
    response = cell.take(request);
  while (response.outcome == Response::INVALID_REQUEST && std::chrono::steady_clock::now() < end);  // tf is on its way
  EXPECT_EQ(response.outcome, Response::TAKEN) << response.message;
  EXPECT_EQ(response.id, wanted.id);
}

TEST(TakePart, RefusesRequestsWithoutSense)
{
  CellUnderTest cell("refuse", {{"tf_timeout", 0}});
  const SceneTruth truth = *cell.expose().truth;
  EXPECT_EQ(cell.takeId(-5).outcome, Response::NO_SUCH_PART);
  geometry_msgs::Pose pose = truth.instances[0].pose;
  Request near = byPose("camera", pose);
  near.pose.pose.position.z -= 0.03;  // beyond the tolerance, and nothing lies above
  near.tolerance = 0.002;
  const Response nothing = cell.take(near);
  EXPECT_EQ(nothing.outcome, Response::NO_SUCH_PART) << nothing.message;
  EXPECT_EQ(nothing.id, -1);
  EXPECT_EQ(nothing.num_left, 5u);

  std::vector<Request> wrong(7, byPose("camera", pose));
  wrong[0].select = 7;
  wrong[1].tolerance = -1;
  wrong[2].tolerance = std::numeric_limits<double>::quiet_NaN();
  wrong[3].pose.header.frame_id = "no_such_frame";
  wrong[4].pose.header.frame_id = "";
  wrong[5].part = "teapot";
  wrong[6].pose.pose.orientation = geometry_msgs::Quaternion();  // forgotten
  for (std::size_t i = 0; i < wrong.size(); ++i)
  {
    const Response response = cell.take(wrong[i]);
    EXPECT_EQ(response.outcome, Response::INVALID_REQUEST) << i << ": " << response.message;
    EXPECT_EQ(response.id, -1);
  }
  EXPECT_EQ(cell.expose().truth->instances.size(), 5u);
}

TEST(TakePart, MissesWithoutMovingAnything)
{
  CellUnderTest cell("miss", {{"failure_probability", 1}});
  const SceneTruth before = *cell.expose().truth;
  const Response response = cell.takeId(before.instances[0].id);
  EXPECT_EQ(response.outcome, Response::MISSED) << response.message;
  EXPECT_EQ(response.id, before.instances[0].id);
  EXPECT_EQ(response.num_left, 5u);
  const SceneTruth after = *cell.expose().truth;
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_EQ(before.instances[i].pose, after.instances.at(i).pose);
}

TEST(TakePart, DropsBackElsewhere)
{
  CellUnderTest cell("drop", {{"drop_probability", 1}});
  const SceneTruth before = *cell.expose().truth;
  const TrueInstance& meant = before.instances[2];
  const Response response = cell.takeId(meant.id);
  EXPECT_EQ(response.outcome, Response::DROPPED_BACK) << response.message;
  EXPECT_EQ(response.num_left, 5u);
  const SceneTruth after = *cell.expose().truth;
  ASSERT_EQ(after.instances.size(), 5u);
  ASSERT_NE(find(after, meant.id), nullptr);
  EXPECT_NE(find(after, meant.id)->pose, meant.pose);
}

TEST(TakePart, LuckFollowsTheSeed)
{
  const std::map<std::string, XmlRpc::XmlRpcValue> parameters = {{"failure_probability", 0.5}, {"counts", 1}};
  CellUnderTest one("luck_one", parameters);
  CellUnderTest two("luck_two", parameters);
  const int id = one.expose().truth->instances.at(0).id;
  two.expose();
  two.expose();  // looking changes nothing
  bool is_taken = false;
  while (!is_taken)
  {
    const Response response = one.takeId(id);
    EXPECT_EQ(two.takeId(id), response);
    is_taken = response.outcome == Response::TAKEN;
    ASSERT_TRUE(is_taken || response.outcome == Response::MISSED);
  }
}

/// Measured points more than 5 mm above the floor and as far from the walls: 20 standard deviations of the noise.
long countInside(const Exposure& exposure, const bin_picking::Bin& bin)
{
  const auto cloud = toPclCloud(*exposure.cloud);
  return std::count_if(cloud.begin(), cloud.end(), [&](const pcl::PointXYZ& p) {
    const Eigen::Vector3d q = bin.T_camera_bin.inverse() * Eigen::Vector3d(p.x, p.y, p.z);
    return std::abs(q.x()) < bin.inner_size.x() / 2 - 0.005 && std::abs(q.y()) < bin.inner_size.y() / 2 - 0.005 &&
           q.z() > 0.005 && q.z() < bin.inner_size.z();
  });
}

TEST(TakePart, EmptiesTheBinFromTheTop)
{
  const auto bin = bin_picking::loadBin(std::string(BIN_PICKING_SOURCE_DIR) + "/config/bins/virtual_cell.yaml");
  CellUnderTest cell("empty", {{"counts", 6}});
  Exposure exposure = cell.expose();
  EXPECT_GT(countInside(exposure, bin), 100);
  for (std::uint32_t num_left = 6; num_left > 0; --num_left)
  {
    ASSERT_TRUE(exposure.complete());
    ASSERT_EQ(exposure.truth->instances.size(), num_left);
    const auto& parts = exposure.truth->instances;
    const auto top = std::max_element(parts.begin(), parts.end(), [](const TrueInstance& a, const TrueInstance& b) {
      return a.visible_fraction < b.visible_fraction;
    });
    const Response response = cell.takeId(top->id);
    ASSERT_EQ(response.outcome, Response::TAKEN) << response.message;
    ASSERT_EQ(response.num_left, num_left - 1);
    exposure = cell.expose();
  }
  EXPECT_TRUE(exposure.truth->instances.empty());
  EXPECT_EQ(countInside(exposure, bin), 0);
  EXPECT_EQ(cell.takeId(0).outcome, Response::NO_SUCH_PART);
}
}  // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "take_part_test");
  ros::NodeHandle nh;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
