// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/avoid_list.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
const Eigen::Vector3d HERE(0.1, -0.05, 0.03);
const Eigen::Vector3d FAR_AWAY(-0.1, 0.1, 0.02);

AvoidParameters someParameters()
{
  AvoidParameters parameters;
  parameters.radius = 0.02;
  parameters.duration = 100;
  parameters.picks = 3;
  parameters.duration_not_attempted = 10;
  return parameters;
}

TEST(AvoidList, holdsTheBallAroundAFailureAndNothingElse)
{
  AvoidList list(someParameters());
  EXPECT_FALSE(list.contains(HERE));
  list.report(PickOutcome::Missed, HERE, 5, "tee");
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, -1)})
  {
    EXPECT_TRUE(list.contains(HERE + 0.0199 * axis));
    EXPECT_FALSE(list.contains(HERE + 0.0201 * axis));
  }
  ASSERT_NE(list.find(HERE), nullptr);
  EXPECT_EQ(list.find(HERE)->part, "tee");
  EXPECT_EQ(list.find(HERE)->since, 5);
  EXPECT_EQ(list.find(HERE)->outcome, PickOutcome::Missed);
}

TEST(AvoidList, everyFailureIsAvoidedUntilItsTimeIsUp)
{
  for (const PickOutcome outcome : {PickOutcome::Missed, PickOutcome::Dropped, PickOutcome::Collision})
  {
    AvoidList list(someParameters());
    list.report(outcome, HERE, 1000);
    list.tick(1099.9);
    EXPECT_TRUE(list.contains(HERE)) << toString(outcome);
    list.tick(1100);
    EXPECT_FALSE(list.contains(HERE)) << toString(outcome);
  }
  AvoidList list(someParameters());
  list.report(PickOutcome::NotAttempted, HERE, 1000);
  list.tick(1009.9);
  EXPECT_TRUE(list.contains(HERE));
  list.tick(1010);
  EXPECT_FALSE(list.contains(HERE)) << "the robot did not try: the part comes again soon";
}

TEST(AvoidList, forgetsAfterPicksElsewhereBecauseThePileHasChanged)
{
  AvoidList list(someParameters());
  list.report(PickOutcome::Collision, HERE, 0);
  list.report(PickOutcome::Picked, FAR_AWAY, 1);
  list.report(PickOutcome::Picked, FAR_AWAY, 2);
  EXPECT_TRUE(list.contains(HERE));
  list.report(PickOutcome::Missed, FAR_AWAY, 2.5);  // changes nothing: no part has left the bin
  EXPECT_TRUE(list.contains(HERE));
  list.report(PickOutcome::Picked, {0, 0, 0}, 3);
  EXPECT_FALSE(list.contains(HERE));
  EXPECT_TRUE(list.contains(FAR_AWAY)) << "only one pick since";
}

TEST(AvoidList, aPickNearbyClearsThePlaceAtOnce)
{
  AvoidList list(someParameters());
  list.report(PickOutcome::Missed, HERE, 0);
  list.report(PickOutcome::Missed, FAR_AWAY, 0);
  list.report(PickOutcome::Picked, HERE + Eigen::Vector3d(0.01, 0, 0), 1);
  EXPECT_FALSE(list.contains(HERE));
  EXPECT_TRUE(list.contains(FAR_AWAY));
}

TEST(AvoidList, aSecondFailureNearbyReplacesTheFirst)
{
  AvoidList list(someParameters());
  list.report(PickOutcome::Missed, HERE, 0);
  list.report(PickOutcome::Picked, FAR_AWAY, 10);
  list.report(PickOutcome::Collision, HERE + Eigen::Vector3d(0.001, 0, 0), 50);
  ASSERT_EQ(list.places().size(), 1u);
  EXPECT_EQ(list.places()[0].outcome, PickOutcome::Collision);
  EXPECT_EQ(list.places()[0].picks_left, 3);
  list.tick(149);
  EXPECT_TRUE(list.contains(HERE)) << "the time counts from the second one";
}

TEST(AvoidList, anAttemptThatWasNotMadeDoesNotShortenAFailure)
{
  for (const PickOutcome outcome : {PickOutcome::Collision, PickOutcome::Missed})
  {
    AvoidList list(someParameters());
    list.report(outcome, HERE, 0);
    list.report(PickOutcome::NotAttempted, HERE + Eigen::Vector3d(0.001, 0, 0), 50);
    ASSERT_EQ(list.places().size(), 1u);
    EXPECT_EQ(list.places()[0].outcome, outcome);
    list.tick(99);
    EXPECT_TRUE(list.contains(HERE)) << "for the whole time after " << toString(outcome);
    // What is nearly over it does replace.
    list.report(PickOutcome::NotAttempted, HERE, 99);
    ASSERT_EQ(list.places().size(), 1u);
    EXPECT_EQ(list.places()[0].outcome, PickOutcome::NotAttempted);
    list.tick(105);
    EXPECT_TRUE(list.contains(HERE));
  }
}

TEST(AvoidList, newestOfTwoOverlappingPlacesIsTold)
{
  AvoidList list(someParameters());
  list.report(PickOutcome::Missed, HERE, 0, "first");
  list.report(PickOutcome::Missed, HERE + Eigen::Vector3d(0.03, 0, 0), 1, "second");
  ASSERT_EQ(list.places().size(), 2u);
  EXPECT_EQ(list.find(HERE + Eigen::Vector3d(0.015, 0, 0))->part, "second");
  EXPECT_EQ(list.find(HERE)->part, "first");
}

TEST(AvoidList, clockThatWasSetBackFreesThePlaces)
{
  AvoidList list(someParameters());
  list.report(PickOutcome::Missed, HERE, 1e6);
  list.tick(10);  // a bag is played again, or the clock was set: when the place would expire is no longer known
  EXPECT_TRUE(list.places().empty());
}

TEST(AvoidList, neverGrowsBeyondItsBound)
{
  AvoidList list(someParameters());
  for (int i = 0; i < 2000; ++i)
    list.report(PickOutcome::Missed, {0.05 * i, 0, 0}, 0.001 * i);
  EXPECT_EQ(list.places().size(), AvoidList::MAX_PLACES);
  EXPECT_TRUE(list.contains({0.05 * 1999, 0, 0}));
  EXPECT_FALSE(list.contains({0, 0, 0})) << "the oldest gives way";
}

TEST(AvoidList, radiusZeroSwitchesItOffAndNonsenseIsRefused)
{
  AvoidParameters parameters = someParameters();
  parameters.radius = 0;
  AvoidList off(parameters);
  off.report(PickOutcome::Missed, HERE, 0);
  EXPECT_FALSE(off.contains(HERE));
  parameters.radius = -1;
  EXPECT_THROW(AvoidList{parameters}, ParameterError);
  AvoidList list(someParameters());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(list.report(PickOutcome::Missed, {0, nan, 0}, 0), ParameterError);
  EXPECT_THROW(list.report(PickOutcome::Picked, HERE, nan), ParameterError);
  EXPECT_TRUE(list.places().empty());
}
}  // namespace
}  // namespace bin_picking
