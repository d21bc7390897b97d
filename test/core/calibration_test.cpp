// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/evaluation/evaluation_summary.hpp"
#include "core/judged_bars.hpp"

namespace bin_picking
{
namespace
{
using namespace test;

TEST(Calibration, OfAHandMadeList)
{
  // Tenths: 0.0 two poses, mean score 0.06, none right; 0.9 four poses, mean score 0.95, three right.
  const Calibration c =
      calibration({{0.02, false}, {0.1 - 1e-9, false}, {0.9, true}, {0.95, true}, {0.95, false}, {1, true}});
  EXPECT_EQ(c.count, 6);
  ASSERT_EQ(c.tenths.size(), 10u);
  EXPECT_NEAR(c.tenths[0].mean_score, 0.06, 1e-9);
  EXPECT_EQ(c.tenths[0].right.hits, 0);
  EXPECT_EQ(c.tenths[0].right.total, 2);
  EXPECT_NEAR(c.tenths[9].mean_score, 0.95, 1e-12);
  EXPECT_EQ(c.tenths[9].right.hits, 3);
  EXPECT_EQ(c.tenths[9].right.total, 4);
  for (std::size_t k = 1; k < 9; ++k)
  {
    EXPECT_EQ(c.tenths[k].right.total, 0) << k;
    EXPECT_TRUE(std::isnan(c.tenths[k].mean_score)) << k;
  }
  EXPECT_NEAR(c.brier_score, (0.02 * 0.02 + 0.1 * 0.1 + 0.1 * 0.1 + 0.05 * 0.05 + 0.95 * 0.95 + 0) / 6, 1e-9);
  EXPECT_NEAR(c.expected_error, (2 * 0.06 + 4 * 0.2) / 6, 1e-9);
}

TEST(Calibration, CertaintyThatIsRightHasNoError)
{
  const Calibration c = calibration({{1, true}, {0, false}, {0, false}});
  EXPECT_EQ(c.brier_score, 0);
  EXPECT_EQ(c.expected_error, 0);
}

TEST(Calibration, AConstantThatIsTheShareOfTheRightIsCalibratedAndKnowsNothing)
{
  const Calibration c = calibration({{0.25, true}, {0.25, false}, {0.25, false}, {0.25, false}});
  EXPECT_NEAR(c.expected_error, 0, 1e-12);
  EXPECT_NEAR(c.brier_score, 0.25 * 0.75, 1e-12);  // the variance of the outcome
}

TEST(Calibration, NothingTestedSaysNothing)
{
  const Calibration none = calibration({});
  EXPECT_EQ(none.count, 0);
  EXPECT_TRUE(std::isnan(none.brier_score));
  EXPECT_TRUE(std::isnan(none.expected_error));
}

TEST(Calibration, OnlyProbabilitiesHaveOne)
{
  EXPECT_THROW(calibration({{1.2, true}}), ParameterError);
  EXPECT_THROW(calibration({{-0.1, true}}), ParameterError);
  EXPECT_THROW(calibration({{std::nan(""), true}}), ParameterError);
}

Detection testedBar(std::size_t k, double score, double shift, const std::string& rejection)
{
  Detection detection;
  detection.part = "bar";
  detection.T_camera_object = bar(k, score, shift).T_camera_object;
  detection.score = score;
  detection.rejection = rejection;
  detection.quality.emplace();
  detection.quality->inlier_share = score;
  return detection;
}

/// One right pose is returned; rejected are a second one on the same bar, one that is 20 mm off, and one that was given
/// up early.
std::vector<TestedPose> testedBars()
{
  DetectionResult result;
  result.detections = {testedBar(0, 0.95, 0, "")};
  result.rejected = {testedBar(0, 0.85, 0.002, "a better detection explains it"), testedBar(1, 0.3, 0.02, "score"),
                     testedBar(1, 0, 0, "hopeless")};
  result.rejected.back().quality.reset();
  return judgeTested(sceneOfBars({1, 1}), result, barShapes(), {});
}

TEST(TestedPoses, AreRightIfTheyHitAnyPartAndNeedAScore)
{
  const std::vector<TestedPose> tested = testedBars();
  ASSERT_EQ(tested.size(), 3u) << "who was given up takes no part";
  EXPECT_TRUE(tested[0].accepted);
  EXPECT_TRUE(tested[0].right);
  EXPECT_FALSE(tested[1].accepted);
  EXPECT_TRUE(tested[1].right) << "a duplicate, but a true pose";
  EXPECT_FALSE(tested[2].accepted);
  EXPECT_FALSE(tested[2].right);
  EXPECT_EQ(tested[2].quality.inlier_share, 0.3);
  EXPECT_EQ(tested[2].part, "bar");
}

TEST(TestedPoses, AreCountedPerPartAndApartFromTheReturnedOnes)
{
  JudgedScene scene = judgeScene(sceneOfBars({1, 1}), {bar(0, 0.95)}, barShapes(), {});
  scene.tested = testedBars();
  const EvaluationSummary summary = summarize({scene, scene}, {"bar", "cube"}, {});
  EXPECT_EQ(summary.all.tested.count, 6);
  EXPECT_EQ(summary.all.tested.tenths[8].right.hits, 2);
  EXPECT_EQ(summary.all.tested.tenths[3].right.hits, 0);
  EXPECT_EQ(summary.all.returned.count, 2);
  EXPECT_NEAR(summary.all.returned.expected_error, 0.05, 1e-12);
  EXPECT_EQ(summary.parts[0].tested.count, 6);
  EXPECT_EQ(summary.parts[1].tested.count, 0);
}
}  // namespace
}  // namespace bin_picking
