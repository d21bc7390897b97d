// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// Which clouds a request may use: those of sensors whose clock is ahead, or that carry no time.
#include "cloud_wait.hpp"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <limits>

#include "return_code.hpp"

namespace
{
using namespace bin_picking_ros;
using sensor_msgs::PointCloud2;
using sensor_msgs::PointCloud2ConstPtr;

PointCloud2ConstPtr stamped(const ros::Time& stamp)
{
  const auto cloud = boost::make_shared<PointCloud2>();
  cloud->header.stamp = stamp;
  return cloud;
}

PointCloud2ConstPtr stampedAhead(double seconds) { return stamped(ros::Time::now() + ros::Duration(seconds)); }

/// As a request makes it at this moment.
CloudWish wishOf(const CloudBuffer& clouds, double seconds)
{
  return {ros::Time::now(), CloudBuffer::Clock::now(), clouds.numReceived(), seconds, "/points"};
}

template <typename Work>
ReturnCode codeOf(Work work)
{
  try
  {
    work();
    return makeReturnCode(ReturnCode::OK, "");
  }
  catch (...)
  {
    return translateException(std::current_exception());
  }
}

TEST(CloudWait, ACloudThatWasThereBeforeTheCallIsNotNewWhateverItsStamp)
{
  CloudBuffer clouds;
  clouds.store(stampedAhead(0.3));  // the scene changed after this exposure
  const CloudWish wish = wishOf(clouds, 0.01);
  const ReturnCode code = codeOf([&] { waitForNew(clouds, wish); });
  EXPECT_EQ(code.value, ReturnCode::NO_CLOUD) << code.message;
  EXPECT_NE(code.message.find("had come before the call"), std::string::npos) << code.message;
  const PointCloud2ConstPtr next = stampedAhead(0.3);
  clouds.store(next);
  EXPECT_EQ(waitForNew(clouds, wish), next);
}

TEST(CloudWait, ACloudThatComesLateButWasExposedBeforeTheCallIsNotNew)
{
  CloudBuffer clouds;
  const CloudWish wish = wishOf(clouds, 0.01);
  clouds.store(stampedAhead(-1));
  const ReturnCode code = codeOf([&] { waitForNew(clouds, wish); });
  EXPECT_EQ(code.value, ReturnCode::NO_CLOUD) << code.message;
  EXPECT_NE(code.message.find("before the call"), std::string::npos) << code.message;
}

TEST(CloudWait, StampsThatNoSynchronisedClockGivesAreRefused)
{
  const ros::Time now = ros::Time::now();
  const auto code = [&](const ros::Time& stamp) { return codeOf([&] { requireCredibleStamp(stamp, now); }); };
  EXPECT_EQ(code(now).value, ReturnCode::OK);
  EXPECT_EQ(code(now - ros::Duration(1e6)).value, ReturnCode::OK) << "age is another question";
  EXPECT_EQ(code(now + ros::Duration(0.9 * MAX_CLOCK_LEAD)).value, ReturnCode::OK);
  EXPECT_EQ(code(ros::Time()).value, ReturnCode::STALE_CLOUD);
  EXPECT_EQ(code(ros::Time(std::numeric_limits<std::uint32_t>::max(), 0)).value, ReturnCode::STALE_CLOUD);
  const ReturnCode ahead = code(now + ros::Duration(3));
  EXPECT_EQ(ahead.value, ReturnCode::STALE_CLOUD);
  EXPECT_NE(ahead.message.find("3 s in the future"), std::string::npos) << ahead.message;
  EXPECT_NE(ahead.hint.find("synchronise the clocks"), std::string::npos) << ahead.hint;
}

TEST(CloudWait, TheLatestCloudNeedsACredibleStampToo)
{
  CloudBuffer clouds;
  const auto code = [&] { return codeOf([&] { takeLatest(clouds, wishOf(clouds, 5)); }).value; };
  EXPECT_EQ(code(), ReturnCode::NO_CLOUD);
  clouds.store(stampedAhead(10));
  EXPECT_EQ(code(), ReturnCode::STALE_CLOUD);
  clouds.store(stamped(ros::Time()));
  EXPECT_EQ(code(), ReturnCode::STALE_CLOUD);
  clouds.store(stampedAhead(-6));
  EXPECT_EQ(code(), ReturnCode::STALE_CLOUD) << "too old";
  clouds.store(stampedAhead(-1));
  EXPECT_EQ(code(), ReturnCode::OK);
}

TEST(CloudWait, ADriverThatGivesNoTimeIsNamedAndNotTakenForSilent)
{
  CloudBuffer clouds;
  const CloudWish wish = wishOf(clouds, 0.01);
  clouds.store(stamped(ros::Time()));
  EXPECT_EQ(codeOf([&] { waitForNew(clouds, wish); }).value, ReturnCode::STALE_CLOUD);
}
}  // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  ros::Time::init();  // no node: there is no master
  return RUN_ALL_TESTS();
}
