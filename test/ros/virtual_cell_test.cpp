// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// The virtual cell as a sensor driver: what it publishes, when, and what it says when it cannot.
#include <cmath>
#include <set>

#include "bin_picking_perception/common/kd_tree.hpp"
#include "cell_under_test.hpp"
#include "cloud_conversion.hpp"
#include "pose_conversion.hpp"

namespace
{
using namespace bin_picking_ros;
using bin_picking::Pose;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(VirtualCell, PublishesAnOrganizedCloudOnTheRaysOfItsCamera)
{
  CellUnderTest cell("rays");
  const ros::Time before = ros::Time::now();
  const Exposure exposure = cell.expose();
  ASSERT_TRUE(exposure.complete());
  const sensor_msgs::PointCloud2& cloud = *exposure.cloud;
  EXPECT_EQ(cloud.width, 160u);
  EXPECT_EQ(cloud.height, 128u);
  EXPECT_EQ(cloud.header.frame_id, "camera");
  EXPECT_GE(cloud.header.stamp, before);
  EXPECT_LE(cloud.header.stamp, ros::Time::now());
  EXPECT_FALSE(cloud.is_dense);
  EXPECT_EQ(exposure.camera_info->header.frame_id, "camera");
  EXPECT_EQ(exposure.camera_info->width, cloud.width);
  EXPECT_EQ(exposure.camera_info->height, cloud.height);
  EXPECT_EQ(exposure.truth->header.frame_id, "camera");

  const auto points = toPclCloud(cloud);
  const auto& K = exposure.camera_info->K;
  std::size_t num_valid = 0;
  for (std::uint32_t v = 0; v < cloud.height; ++v)
    for (std::uint32_t u = 0; u < cloud.width; ++u)
    {
      const pcl::PointXYZ& p = points.at(static_cast<int>(u), static_cast<int>(v));
      ASSERT_EQ(std::isnan(p.x), std::isnan(p.z));
      if (std::isnan(p.z))
        continue;
      ++num_valid;
      ASSERT_GT(p.z, 0.5f);  // the camera hangs 0.8 m above the floor: millimetres would be hundreds
      ASSERT_LT(p.z, 1.0f);
      ASSERT_NEAR(K[0] * p.x / p.z + K[2], u, 0.01);  // float32 and no more
      ASSERT_NEAR(K[4] * p.y / p.z + K[5], v, 0.01);
    }
  EXPECT_LT(num_valid, points.size());      // shadows of the projector, edges
  EXPECT_GT(num_valid, points.size() / 5);  // the bin fills more than a quarter of the picture
}

/// Points of the surfaces of all parts at their true poses, 1 mm apart, camera frame.
bin_picking::KdTree trueSurface(const SceneTruth& truth)
{
  const auto block = bin_picking::loadMesh(std::string(BIN_PICKING_SOURCE_DIR) + "/test/ros/step_block/step_block.obj",
                                           bin_picking::LengthUnit::Millimetre);
  const auto samples = bin_picking::sampleSurface(block, 0.001, 1);
  std::vector<Eigen::Vector3f> surface;
  for (const auto& instance : truth.instances)
    for (const auto& point : bin_picking::transformed(samples, fromMessage(instance.pose)).points)
      surface.push_back(point);
  return bin_picking::KdTree(surface);
}

TEST(VirtualCell, TruthIsWhatTheCloudShows)
{
  CellUnderTest cell("truth", {{"counts", 6}, {"bin_frame", "truth_bin"}});
  const Exposure exposure = cell.expose();
  ASSERT_TRUE(exposure.complete());
  ASSERT_EQ(exposure.truth->instances.size(), 6u);
  std::set<int> ids;
  int pixels_of_parts = 0;
  for (const auto& instance : exposure.truth->instances)
  {
    ids.insert(instance.id);
    pixels_of_parts += instance.valid_pixels;
    EXPECT_EQ(instance.part, "step_block");
    EXPECT_LE(instance.valid_pixels, instance.visible_pixels);
    EXPECT_GE(instance.visible_fraction, 0);
    EXPECT_LE(instance.visible_fraction, 1);
  }
  EXPECT_EQ(ids.size(), 6u);
  EXPECT_GT(pixels_of_parts, 100);  // each block fills about 15 x 10 pixels

  // A measured point is on a part as often as the truth says. Within 3 mm: beyond the noise (0.2 mm) and the spacing of
  // the samples, and less than what separates most of the floor from the parts.
  const bin_picking::KdTree surface = trueSurface(*exposure.truth);
  int num_on_parts = 0;
  for (const pcl::PointXYZ& p : toPclCloud(*exposure.cloud))
    if (!std::isnan(p.z) && surface.nearest({p.x, p.y, p.z}, 0.003f).index >= 0)
      ++num_on_parts;
  EXPECT_GE(num_on_parts, 0.95 * pixels_of_parts);                    // 5 %: mixed pixels at the edges
  EXPECT_LE(num_on_parts, pixels_of_parts + 0.35 * pixels_of_parts);  // the seam of floor around the parts
}

TEST(VirtualCell, OneSeedGivesTheSameBytes)
{
  CellUnderTest one("one");
  CellUnderTest two("two");
  CellUnderTest other("other", {{"seed", 2}});
  std::vector<Exposure> first = {one.expose(), one.expose()};
  std::vector<Exposure> second = {two.expose(), two.expose()};
  for (const int k : {0, 1})
  {
    ASSERT_TRUE(first[k].complete() && second[k].complete());
    EXPECT_TRUE(first[k].cloud->data == second[k].cloud->data) << "exposure " << k;
    ASSERT_EQ(first[k].truth->instances.size(), second[k].truth->instances.size());
    for (std::size_t i = 0; i < first[k].truth->instances.size(); ++i)
      EXPECT_EQ(first[k].truth->instances[i], second[k].truth->instances[i]);
  }
  EXPECT_FALSE(first[0].cloud->data == first[1].cloud->data) << "an exposure repeats the noise of the one before";
  EXPECT_FALSE(other.expose().cloud->data == first[0].cloud->data);
}

TEST(VirtualCell, TellsThatItIsNotReadyAndCanBeEndedThen)
{
  CellUnderTest cell("busy", {{"counts", 60}});
  const auto trigger = cell.call("trigger");  // filling takes seconds
  EXPECT_FALSE(trigger.success);
  EXPECT_EQ(cell.takeId(0).outcome, TakePart::Response::NOT_READY);
  EXPECT_FALSE(cell.call("refill").success);
  cell.destroyNode();  // hangs if the filling cannot be ended
}

TEST(VirtualCell, ExposesPeriodically)
{
  CellUnderTest cell("periodic", {{"rate", 20}, {"sensor/type", "ideal"}});
  ros::Time last = ros::Time::now();
  for (int i = 0; i < 3; ++i)
  {
    const Exposure exposure = cell.collector().since(last + ros::Duration(0, 1));
    ASSERT_TRUE(exposure.complete());
    EXPECT_GT(exposure.cloud->header.stamp, last);
    last = exposure.cloud->header.stamp;
  }
}

TEST(VirtualCell, RefillsWithTheNextSeed)
{
  CellUnderTest cell("refill", {{"counts", 3}, {"seed", 7}});
  const Exposure first = cell.expose();
  const auto refill = cell.call("refill");
  ASSERT_TRUE(refill.success) << refill.message;
  EXPECT_TRUE(contains(refill.message, "3 parts") && contains(refill.message, "seed 8")) << refill.message;
  const Exposure second = cell.expose();
  CellUnderTest fresh("fresh", {{"counts", 3}, {"seed", 8}});
  const Exposure expected = fresh.expose();
  ASSERT_TRUE(first.complete() && second.complete() && expected.complete());
  EXPECT_NE(first.truth->instances.at(0), second.truth->instances.at(0));
  EXPECT_EQ(expected.truth->instances.at(0).pose, second.truth->instances.at(0).pose);
}

TEST(VirtualCell, ShakesUpWhatLiesInTheBin)
{
  CellUnderTest cell("shake", {{"counts", 3}});
  const Exposure before = cell.expose();
  ASSERT_TRUE(before.complete());
  EXPECT_EQ(cell.takeId(before.truth->instances[0].id).num_left, 2u);
  const auto shaken = cell.call("shake");
  ASSERT_TRUE(shaken.success) << shaken.message;
  EXPECT_TRUE(contains(shaken.message, "2 parts")) << shaken.message;
  const Exposure after = cell.expose();
  ASSERT_EQ(after.truth->instances.size(), 2u);
  for (const auto& now : after.truth->instances)
    for (const auto& then : before.truth->instances)
    {
      EXPECT_NE(now.id, then.id);
      EXPECT_NE(now.pose, then.pose);
    }
  for (const auto& instance : after.truth->instances)
    cell.takeId(instance.id);
  EXPECT_TRUE(cell.call("shake").success) << "an empty bin may be shaken too";
}

// About every third filling finds room below the rim.
const std::map<std::string, XmlRpc::XmlRpcValue> FULL_BIN = {
    {"counts", 7}, {"layout/bin_length", 0.12}, {"layout/bin_width", 0.1}, {"layout/bin_height", 0.04}};

TEST(VirtualCell, ABinThatThePhysicsCannotFillAgainHasFailedUntilItIsRefilled)
{
  CellUnderTest cell("full", FULL_BIN);
  const auto until = [&cell](const char* service, bool success) {
    auto response = cell.call(service);
    for (int k = 0; k < 100 && static_cast<bool>(response.success) != success; ++k)
    {
      ros::WallDuration(0.05).sleep();  // the first filling may be under way
      response = cell.call(service);
    }
    EXPECT_EQ(static_cast<bool>(response.success), success) << response.message;
    return response.message;
  };
  until("refill", true);
  const std::string why = until("shake", false);
  EXPECT_TRUE(contains(why, "too full") && contains(why, "~refill")) << why;
  const TakePart::Response refused = cell.takeId(1);
  EXPECT_EQ(refused.outcome, TakePart::Response::FAILED) << refused.message;
  EXPECT_TRUE(contains(refused.message, "too full")) << refused.message;
  EXPECT_FALSE(cell.call("trigger").success) << "a bin that is half full is no good";
  until("refill", true);
  EXPECT_TRUE(cell.call("trigger").success);
}

struct Mistake
{
  const char* name;
  std::map<std::string, XmlRpc::XmlRpcValue> parameters;
  const char* wanted;  ///< what the sentence must hold
};

const std::string TEE = std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/three_way_tube";

class MistakeTest : public testing::TestWithParam<Mistake>
{
};

TEST_P(MistakeTest, IsAnsweredWithASentence)
{
  CellUnderTest cell(std::string("mistake_") + GetParam().name, GetParam().parameters);
  const std::string sentence = cell.failure();
  EXPECT_TRUE(contains(sentence, GetParam().wanted)) << sentence;
  EXPECT_FALSE(cell.call("refill").success);  // the same again, and not a crash
}

INSTANTIATE_TEST_SUITE_P(
    VirtualCell, MistakeTest,
    testing::Values(
        Mistake{"unknown_name", {{"sensor/heigth", 128}}, "sensor/height"},
        Mistake{"range", {{"failure_probability", 1.5}}, "1.5"},
        Mistake{"no_folder", {{"parts", "/no/such/part"}}, "/no/such/part"},
        Mistake{"no_parts", {{"parts", ""}}, "parts"}, Mistake{"none", {{"counts", 0}}, "0"},
        Mistake{"counts", {{"counts", "1, 2"}}, "counts"},
        Mistake{"too_large", {{"layout/bin_length", 0.05}, {"layout/bin_width", 0.05}, {"parts", TEE}}, "too large"},
        Mistake{"too_many", {{"counts", 61}}, "60"}),
    [](const auto& mistake) { return std::string(mistake.param.name); });
}  // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "virtual_cell_test");
  ros::NodeHandle nh;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
