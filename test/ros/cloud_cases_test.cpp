// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// What the detector says to clouds of every kind, and that it lives on after each.
#include <algorithm>
#include <functional>
#include <limits>

#include "detector_node_fixture.hpp"

namespace
{
using namespace bin_picking_ros;
using sensor_msgs::PointCloud2;
using test_clouds::Layout;

struct CloudCase
{
  const char* name;
  std::function<PointCloud2(const bin_picking::DepthGrid&)> make;
  std::int16_t expected;
};

class CloudCaseTest : public DetectorNodeTest, public testing::WithParamInterface<CloudCase>
{
};

TEST_P(CloudCaseTest, IsAnsweredWithItsCode)
{
  camera_->start(GetParam().make(scene_->grid));
  const auto response = ask();
  camera_->stop();
  EXPECT_EQ(response.code.value, GetParam().expected) << response.code.name << ": " << response.code.message;
  EXPECT_FALSE(response.code.message.empty());
  if (GetParam().expected < 0)
  {
    EXPECT_TRUE(response.detections.empty());
    EXPECT_FALSE(response.code.hint.empty());
    const auto latched = receive<bin_picking_perception::DetectionArray>("/cell/detector/detections");
    ASSERT_TRUE(latched);
    EXPECT_EQ(latched->code.value, GetParam().expected) << "an old result is still latched";
  }
  expectGoodAnswer();
}

PointCloud2 without(const bin_picking::DepthGrid& grid, const char* field)
{
  Layout layout;
  layout.order.erase(std::find(layout.order.begin(), layout.order.end(), field));
  return makeMessage(grid, layout);
}

const float NOT_A_NUMBER = std::numeric_limits<float>::quiet_NaN();

const std::vector<CloudCase> CLOUD_CASES = {
    {"Empty",
     [](const auto&) {
       auto m = PointCloud2();
       m.header.frame_id = "camera";
       return m;
     },
     ReturnCode::BAD_CLOUD},
    {"Unorganized",
     [](const auto& grid) {
       auto m = makeMessage(grid);
       m.width *= m.height;
       m.height = 1;
       m.row_step = m.width * m.point_step;
       return m;
     },
     ReturnCode::BAD_CLOUD},
    {"AllNan",
     [](const auto& grid) { return makeMessage(test_clouds::mapped(grid, [](float) { return NOT_A_NUMBER; })); },
     ReturnCode::BAD_CLOUD},
    {"AllZero", [](const auto& grid) { return makeMessage(test_clouds::mapped(grid, [](float) { return 0.0f; })); },
     ReturnCode::BAD_CLOUD},
    {"WithoutX", [](const auto& grid) { return without(grid, "x"); }, ReturnCode::BAD_CLOUD},
    {"WithoutY", [](const auto& grid) { return without(grid, "y"); }, ReturnCode::BAD_CLOUD},
    {"WithoutZ", [](const auto& grid) { return without(grid, "z"); }, ReturnCode::BAD_CLOUD},
    {"Truncated",
     [](const auto& grid) {
       auto m = makeMessage(grid);
       m.data.resize(m.data.size() / 2);
       return m;
     },
     ReturnCode::BAD_CLOUD},
    {"Millimetres",
     [](const auto& grid) { return makeMessage(test_clouds::mapped(grid, [](float v) { return 1000 * v; })); },
     ReturnCode::UNIT_SUSPECT},
    {"WithoutFrame",
     [](const auto& grid) {
       auto m = makeMessage(grid);
       m.header.frame_id.clear();
       return m;
     },
     ReturnCode::BAD_CLOUD},
    {"UnknownFrame",
     [](const auto& grid) {
       auto m = makeMessage(grid);
       m.header.frame_id = "moon";
       return m;
     },
     ReturnCode::TF_UNKNOWN_FRAME},
    {"EmptyBin",
     [](auto grid) {
       for (int i = 0; i < static_cast<int>(grid.size()); ++i)
         if (grid.z[static_cast<std::size_t>(i)] < 0.5999f)
           grid.invalidate(i);
       return makeMessage(grid);
     },
     ReturnCode::BIN_EMPTY},
    {"Float64",
     [](const auto& grid) {
       Layout l;
       l.float64 = true;
       return makeMessage(grid, l);
     },
     ReturnCode::OK},
    {"BigEndian",
     [](const auto& grid) {
       Layout l;
       l.big_endian = true;
       return makeMessage(grid, l);
     },
     ReturnCode::OK},
    {"PaddedAndShuffled",
     [](const auto& grid) {
       Layout l;
       l.order = {"z", "y", "x"};
       l.lead = 4;
       l.row_padding = 12;
       return makeMessage(grid, l);
     },
     ReturnCode::OK},
    {"ZeroWhereNotMeasured",
     [](const auto& grid) {
       return makeMessage(test_clouds::mapped(grid, [](float v) { return std::isnan(v) ? 0.0f : v; }));
     },
     ReturnCode::OK},
};

INSTANTIATE_TEST_SUITE_P(Clouds, CloudCaseTest, testing::ValuesIn(CLOUD_CASES),
                         [](const auto& cloud_case) { return std::string(cloud_case.param.name); });
}  // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "cloud_cases_test");
  ros::NodeHandle nh;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
