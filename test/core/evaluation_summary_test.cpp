// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/evaluation_summary.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/judged_bars.hpp"

namespace bin_picking
{
namespace
{
using namespace test;

JudgedScene judge(const EvaluationScene& scene, const std::vector<PoseEstimate>& estimates)
{
  static const PartShapes SHAPES = barShapes();
  return judgeScene(scene, estimates, SHAPES, {});
}

EvaluationFigures figuresOf(const std::vector<JudgedScene>& scenes) { return summarize(scenes, {"bar"}, {}).all; }

void expectRatio(const Ratio& ratio, int hits, int total)
{
  EXPECT_EQ(ratio.hits, hits);
  EXPECT_EQ(ratio.total, total);
}

TEST(Summary, PerfectIsOneEverywhere)
{
  const EvaluationFigures f = figuresOf({judge(sceneOfBars({1, 0.6}), {bar(0, 0.9), bar(1, 0.8)})});
  EXPECT_EQ(f.scenes, 1);
  EXPECT_EQ(f.instances, 2);
  EXPECT_EQ(f.pickable, 2);
  EXPECT_EQ(f.right, 2);
  ASSERT_EQ(f.recall.size(), 2u);
  expectRatio(f.recall[0].ratio, 2, 2);
  expectRatio(f.recall[1].ratio, 1, 1);  // only one is visible by 0.85
  expectRatio(f.precision, 2, 2);
  ASSERT_EQ(f.first.size(), 3u);
  expectRatio(f.first[0].ratio, 1, 1);
  expectRatio(f.first[1].ratio, 2, 2);  // two were returned, not three
  expectRatio(f.first[2].ratio, 2, 2);
  EXPECT_DOUBLE_EQ(f.average_precision.value(), 1);
  expectRatio(f.empty_scenes, 0, 0);
  expectRatio(f.mean_distance_recall, 2, 2);
  EXPECT_NEAR(f.translation.median, 0, 1e-12);
}

TEST(Summary, ShiftsAreReportedByMedianAndPercentile)
{
  const EvaluationFigures f =
      figuresOf({judge(sceneOfBars({1, 1, 1}), {bar(0, 0.9, 0.001), bar(1, 0.8, 0.002), bar(2, 0.7, 0.004)})});
  EXPECT_NEAR(f.translation.median, 0.002, 1e-9);
  EXPECT_NEAR(f.translation.p95, 0.002 + 0.9 * 0.002, 1e-9);
  EXPECT_EQ(f.translation.count, 3);
  EXPECT_NEAR(f.rotation.median, 0, 1e-7);
  EXPECT_LT(f.mean_distance.median, 0.002);
  EXPECT_GT(f.mean_distance.median, 0);
}

TEST(Summary, DuplicatesAndWrongOnesCostPrecisionButNotRecall)
{
  const EvaluationFigures f =
      figuresOf({judge(sceneOfBars({1, 1}), {bar(0, 0.9), bar(0, 0.8, 0.001), bar(1, 0.7), bar(5, 0.6)})});
  EXPECT_EQ(f.right, 2);
  EXPECT_EQ(f.duplicates, 1);
  EXPECT_EQ(f.wrong, 1);
  expectRatio(f.recall[0].ratio, 2, 2);
  expectRatio(f.precision, 2, 4);
  expectRatio(f.first[0].ratio, 1, 1);
  expectRatio(f.first[1].ratio, 2, 3);
  expectRatio(f.first[2].ratio, 2, 4);
  // Right, wrong, right, wrong of 2: 1/2 * 1 + 1/2 * 2/3.
  EXPECT_NEAR(f.average_precision.value(), 5.0 / 6, 1e-12);
}

TEST(Summary, HitsOnHiddenPartsAreTrueButNotAskedFor)
{
  const EvaluationFigures f = figuresOf({judge(sceneOfBars({1, 0.3}), {bar(1, 0.9), bar(0, 0.8)})});
  EXPECT_EQ(f.instances, 2);
  EXPECT_EQ(f.pickable, 1);
  EXPECT_EQ(f.hidden, 1);
  expectRatio(f.recall[0].ratio, 1, 1);
  expectRatio(f.precision, 2, 2);
  expectRatio(f.first[0].ratio, 1, 1);
  EXPECT_DOUBLE_EQ(f.average_precision.value(), 1) << "neither right nor wrong";
}

TEST(Summary, RecallIsToldWithAndWithoutPosesThatLeaveATurnOpen)
{
  PoseEstimate open = bar(0, 0.9);
  open.T_camera_object = open.T_camera_object * Eigen::AngleAxisd(1, Eigen::Vector3d::UnitX());
  open.undetermined_turn = UndeterminedTurn{{Eigen::Vector3d::UnitX(), Eigen::Vector3d::Zero()}, {}, 0.001};
  PoseEstimate off = open;
  off.T_camera_object = Eigen::Translation3d(0, 0.05, 0) * off.T_camera_object;
  off.score = 0.5;
  const EvaluationFigures f = figuresOf({judge(sceneOfBars({1, 1, 0.6}), {open, bar(1, 0.8), off})});
  expectRatio(f.recall[0].ratio, 2, 3);
  expectRatio(f.recall[0].turn_known, 1, 3);
  expectRatio(f.recall[1].ratio, 2, 2);
  expectRatio(f.recall[1].turn_known, 1, 2);
  expectRatio(f.undetermined, 1, 2);
  expectRatio(f.precision, 2, 3);
  EXPECT_NEAR(f.average_precision.value(), 2.0 / 3, 1e-12);
}

TEST(Summary, EmptyBinsCountWhatIsFoundInThem)
{
  const EvaluationFigures f =
      figuresOf({judge(sceneOfBars({}), {bar(0, 0.9), bar(1, 0.5)}), judge(sceneOfBars({}), {})});
  expectRatio(f.empty_scenes, 1, 2);
  EXPECT_EQ(f.false_in_empty, 2);
  EXPECT_EQ(f.pickable, 0);
  expectRatio(f.first[0].ratio, 0, 0);  // there was nothing to pick
  expectRatio(f.precision, 0, 2);
  EXPECT_FALSE(f.average_precision.has_value());
  EXPECT_TRUE(std::isnan(f.translation.median));
}

TEST(Summary, NothingFoundIsAMissOfTheFirst)
{
  const EvaluationFigures f = figuresOf({judge(sceneOfBars({1, 1}), {})});
  expectRatio(f.recall[0].ratio, 0, 2);
  expectRatio(f.precision, 0, 0);
  for (const FirstPrecision& first : f.first)
    expectRatio(first.ratio, 0, 1);
  EXPECT_DOUBLE_EQ(f.average_precision.value(), 0);
  EXPECT_EQ(missedInstances(judge(sceneOfBars({1, 0.2}), {}), 0.5), (std::vector<std::size_t>{0}));
}

TEST(Summary, AllWrongIsZero)
{
  const EvaluationFigures f = figuresOf({judge(sceneOfBars({1, 1}), {bar(5, 0.9), bar(0, 0.8, 0.02)})});
  EXPECT_EQ(f.wrong, 2);
  expectRatio(f.recall[0].ratio, 0, 2);
  expectRatio(f.precision, 0, 2);
  expectRatio(f.first[0].ratio, 0, 1);
  EXPECT_DOUBLE_EQ(f.average_precision.value(), 0);
  EXPECT_EQ(f.translation.count, 0);
}

TEST(Summary, ScoresArePooledOverScenes)
{
  // By score over both scenes: right 0.9, wrong 0.8, right 0.7; two to be found: 1/2 * 1 + 1/2 * 2/3.
  const EvaluationFigures f =
      figuresOf({judge(sceneOfBars({1}), {bar(0, 0.7), bar(3, 0.8)}), judge(sceneOfBars({1}), {bar(0, 0.9)})});
  EXPECT_NEAR(f.average_precision.value(), 5.0 / 6, 1e-12);
  expectRatio(f.first[0].ratio, 1, 2);  // in the first scene the wrong one has the better score
}

TEST(Summary, PartsAreCountedApartAndTogether)
{
  EvaluationScene scene = sceneOfBars({1});
  scene.parts = {"bar", "cube"};
  scene.instances.push_back(instanceOf("cube", poseAt(0, 0.2)));
  const JudgedScene mixed = judge(scene, {bar(0, 0.9), {"cube", poseAt(0, 0.4), 0.8}});
  const EvaluationSummary summary = summarize({mixed, judge(sceneOfBars({1}), {bar(0, 0.5)})}, {"bar", "cube"}, {});
  ASSERT_EQ(summary.parts.size(), 2u);
  EXPECT_EQ(summary.parts[0].part, "bar");
  EXPECT_EQ(summary.parts[0].scenes, 2);
  expectRatio(summary.parts[0].recall[0].ratio, 2, 2);
  EXPECT_DOUBLE_EQ(summary.parts[0].average_precision.value(), 1);
  EXPECT_EQ(summary.parts[1].scenes, 1);
  expectRatio(summary.parts[1].recall[0].ratio, 0, 1);
  EXPECT_DOUBLE_EQ(summary.parts[1].average_precision.value(), 0);
  expectRatio(summary.all.recall[0].ratio, 2, 3);
  expectRatio(summary.all.first[0].ratio, 2, 2);
  EXPECT_DOUBLE_EQ(summary.all.average_precision.value(), 0.5) << "mean over the parts";
}

TEST(Summary, TimesAreThoseOfAllRuns)
{
  JudgedScene fast = judge(sceneOfBars({1}), {});
  JudgedScene slow = fast;
  fast.runs = {{0.1, {{"voting", 0.06}, {"icp", 0.04}}, {}}, {0.2, {{"voting", 0.1}, {"icp", 0.1}}, {}}};
  slow.runs = {{0.9, {{"voting", 0.8}}, {}}};
  const EvaluationSummary summary = summarize({fast, slow}, {"bar"}, {});
  EXPECT_DOUBLE_EQ(summary.total.median, 0.2);
  EXPECT_EQ(summary.total.count, 3);
  ASSERT_EQ(summary.stages.size(), 2u);
  EXPECT_EQ(summary.stages[0].stage, "voting");
  EXPECT_DOUBLE_EQ(summary.stages[0].seconds.median, 0.1);
  EXPECT_NEAR(summary.stages[1].seconds.p95, 0.097, 1e-12);
}
}  // namespace
}  // namespace bin_picking
