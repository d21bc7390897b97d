// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <numeric>

#include "../../src/core/detector/stages.hpp"

namespace bin_picking
{
namespace
{
/// A pose that passed its tests and explains `count` cells from `first` on.
Assessed pose(const std::string& name, double score, int first, int count)
{
  Assessed assessed;
  assessed.detection.part = name;
  assessed.detection.score = score;
  assessed.cells.resize(static_cast<std::size_t>(count));
  std::iota(assessed.cells.begin(), assessed.cells.end(), first);
  return assessed;
}

Assessed rejected(Assessed assessed, const std::string& reason)
{
  assessed.detection.rejection = reason;
  return assessed;
}

DetectionResult select(std::vector<Assessed> poses, const DetectorParameters& parameters = {})
{
  DetectionResult result;
  selectDetections(std::move(poses), parameters, result);
  return result;
}

std::string names(const std::vector<Detection>& detections)
{
  std::string text;
  for (const Detection& detection : detections)
    text += (text.empty() ? "" : " ") + detection.part;
  return text;
}
}  // namespace

TEST(SelectDetections, KeepsPartsSideBySideBestFirst)
{
  const DetectionResult result = select({pose("second", 0.8, 0, 100), pose("first", 0.9, 100, 20)});
  EXPECT_EQ(names(result.detections), "first second");
  EXPECT_TRUE(result.rejected.empty());
}

// A turned pose that calls hidden what it does not explain may fit the rest a little better.
TEST(SelectDetections, OfPosesAtOnePlaceTheOneThatExplainsMoreStays)
{
  const DetectionResult result = select({pose("turned", 0.99, 0, 70), pose("right", 0.96, 0, 83)});
  EXPECT_EQ(names(result.detections), "right");
  ASSERT_EQ(names(result.rejected), "turned");
  EXPECT_EQ(result.rejected.front().rejection, "a detection that explains more explains 100 % of the same points");
}

TEST(SelectDetections, ADoubtfulPoseDoesNotDriveOutASureOneByItsSize)
{
  const DetectionResult result = select({pose("doubtful", 0.5, 0, 120), pose("sure", 0.99, 0, 80)});
  EXPECT_EQ(names(result.detections), "sure");
  EXPECT_EQ(names(result.rejected), "doubtful");
}

TEST(SelectDetections, WhatFailedATestTakesNoPlace)
{
  const DetectionResult result =
      select({rejected(pose("failed", 0.9, 0, 200), "its own reason"), pose("good", 0.8, 0, 100)});
  EXPECT_EQ(names(result.detections), "good");
  ASSERT_EQ(names(result.rejected), "failed");
  EXPECT_EQ(result.rejected.front().rejection, "its own reason");
}

TEST(SelectDetections, OfTooManyTheBestAreReturnedWhateverTheirSize)
{
  DetectorParameters parameters;
  parameters.max_detections = 2;
  parameters.max_rejected = 1;
  const DetectionResult result = select({pose("c", 0.7, 0, 300), pose("b", 0.8, 300, 20), pose("a", 0.9, 400, 10),
                                         rejected(pose("d", 0.6, 500, 10), "its own reason")},
                                        parameters);
  EXPECT_EQ(names(result.detections), "a b");
  ASSERT_EQ(names(result.rejected), "c");
  EXPECT_EQ(result.rejected.front().rejection, "max_detections better ones were found");
}
}  // namespace bin_picking
