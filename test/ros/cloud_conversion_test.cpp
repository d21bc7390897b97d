// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "cloud_conversion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "bin_picking_perception/common/error.hpp"
#include "cloud_messages.hpp"

namespace
{
using bin_picking::CloudError;
using bin_picking::CloudFault;
using bin_picking_ros::summarizeCloud;
using bin_picking_ros::toPclCloud;
using sensor_msgs::PointCloud2;
using test_clouds::Layout;
using test_clouds::makeMessage;

/// 5 x 3 points whose coordinates all differ; one is not measured.
bin_picking::DepthGrid smallGrid()
{
  bin_picking::DepthGrid grid = bin_picking::makeGrid(5, 3, {});
  for (int i = 0; i < 15; ++i)
  {
    const auto k = static_cast<std::size_t>(i);
    grid.x[k] = 0.01f * static_cast<float>(i);
    grid.y[k] = -0.25f + 0.003f * static_cast<float>(i);
    grid.z[k] = 0.7f + 0.0001f * static_cast<float>(i);
  }
  grid.invalidate(7);
  return grid;
}

void expectSameAsGrid(const PointCloud2& message, const bin_picking::DepthGrid& grid)
{
  const auto cloud = toPclCloud(message);
  ASSERT_EQ(cloud.width, static_cast<std::uint32_t>(grid.width));
  ASSERT_EQ(cloud.height, static_cast<std::uint32_t>(grid.height));
  EXPECT_FALSE(cloud.is_dense);
  for (std::size_t i = 0; i < grid.size(); ++i)
  {
    if (!grid.valid(static_cast<int>(i)))
    {
      EXPECT_TRUE(std::isnan(cloud.points[i].x) && std::isnan(cloud.points[i].y) && std::isnan(cloud.points[i].z)) << i;
      continue;
    }
    EXPECT_EQ(cloud.points[i].x, grid.x[i]) << i;
    EXPECT_EQ(cloud.points[i].y, grid.y[i]) << i;
    EXPECT_EQ(cloud.points[i].z, grid.z[i]) << i;
  }
}

CloudFault faultOf(const PointCloud2& message)
{
  try
  {
    toPclCloud(message);
  }
  catch (const CloudError& error)
  {
    EXPECT_GT(std::string(error.what()).size(), 20u);
    return error.fault();
  }
  ADD_FAILURE() << "the cloud was accepted";
  return CloudFault::NoProjection;
}

TEST(CloudConversion, ReadsEveryLayoutToTheSameBits)
{
  const auto grid = smallGrid();
  for (const bool float64 : {false, true})
    for (const bool big_endian : {false, true})
      for (const std::uint32_t lead : {0u, 3u})
        for (const std::uint32_t padding : {0u, 5u})
        {
          Layout layout;
          layout.order = {"intensity", "z", "x", "y"};
          layout.float64 = float64;
          layout.big_endian = big_endian;
          layout.lead = lead;
          layout.point_padding = padding;
          layout.row_padding = 2 * padding;
          expectSameAsGrid(makeMessage(grid, layout), grid);
        }
}

TEST(CloudConversion, LastRowNeedsNoPadding)
{
  Layout layout;
  layout.row_padding = 64;
  PointCloud2 message = makeMessage(smallGrid(), layout);
  message.data.resize(message.data.size() - 64);
  expectSameAsGrid(message, smallGrid());
}

TEST(CloudConversion, NamesWhatIsWrong)
{
  EXPECT_EQ(faultOf(PointCloud2()), CloudFault::Empty);
  for (const char* missing : {"x", "y", "z"})
  {
    PointCloud2 message = makeMessage(smallGrid());
    for (auto& field : message.fields)
      if (field.name == missing)
        field.name = "other";
    EXPECT_EQ(faultOf(message), CloudFault::BadLayout) << missing;
  }
  PointCloud2 integers = makeMessage(smallGrid());
  integers.fields[1].datatype = sensor_msgs::PointField::INT32;
  EXPECT_EQ(faultOf(integers), CloudFault::BadLayout);
}

TEST(CloudConversion, NeverReadsBeyondTheData)
{
  PointCloud2 truncated = makeMessage(smallGrid());
  truncated.data.pop_back();
  EXPECT_EQ(faultOf(truncated), CloudFault::BadLayout);
  PointCloud2 outside = makeMessage(smallGrid());
  outside.fields[2].offset = outside.point_step - 3;
  EXPECT_EQ(faultOf(outside), CloudFault::BadLayout);
  PointCloud2 short_rows = makeMessage(smallGrid());
  short_rows.row_step = short_rows.point_step * short_rows.width - 1;
  EXPECT_EQ(faultOf(short_rows), CloudFault::BadLayout);
  // 2^16 x 2^16 points of 2^16 bytes: the product wraps around to 0 in 32 and in 48 bits
  PointCloud2 huge = makeMessage(smallGrid());
  huge.width = huge.height = huge.point_step = 1u << 16;
  huge.row_step = 0;
  EXPECT_EQ(faultOf(huge), CloudFault::BadLayout);
  PointCloud2 far_offset = makeMessage(smallGrid());
  far_offset.fields[0].offset = std::numeric_limits<std::uint32_t>::max() - 1;
  EXPECT_EQ(faultOf(far_offset), CloudFault::BadLayout);
}

TEST(CloudSummary, CountsWhatIsMeasured)
{
  auto grid = smallGrid();
  grid.x[3] = grid.y[3] = grid.z[3] = 0.0f;
  grid.z[4] = std::numeric_limits<float>::infinity();
  const auto summary = summarizeCloud(makeMessage(grid), 1);
  EXPECT_EQ(summary.sampled, 15u);
  EXPECT_EQ(summary.valid, 12u);  // one NaN, one zero, one infinite
  EXPECT_NEAR(summary.median_depth, 0.7008, 0.0002);
  EXPECT_EQ(summarizeCloud(makeMessage(grid), 2).sampled, 6u);  // 3 columns x 2 rows

  const auto nothing = summarizeCloud(makeMessage(bin_picking::makeGrid(4, 4, {})), 1);
  EXPECT_EQ(nothing.validShare(), 0.0);
  EXPECT_TRUE(std::isnan(nothing.median_depth));
}
}  // namespace
