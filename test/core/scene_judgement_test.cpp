// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include "bin_picking_perception/common/error.hpp"
#include "core/judged_bars.hpp"
#include "core/temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using namespace test;

JudgedScene judge(const EvaluationScene& scene, const std::vector<PoseEstimate>& estimates,
                  const EvaluationParameters& parameters = {})
{
  return judgeScene(scene, estimates, barShapes(), parameters);
}

std::vector<Verdict> verdicts(const JudgedScene& judged)
{
  std::vector<Verdict> all;
  for (const JudgedEstimate& e : judged.estimates)
    all.push_back(e.verdict);
  return all;
}

TEST(PartShape, OfABox)
{
  const PartShape shape = barShapes().at("bar");
  EXPECT_NEAR(shape.diameter, std::sqrt(0.0084), 1e-6);
  EXPECT_EQ(shape.extreme_points.size(), 8u);
  EXPECT_LT(shape.center.norm(), 1e-9);
  EXPECT_NEAR(static_cast<double>(shape.surface_points.size()), 2000, 40);
  EXPECT_THROW(makePartShape({}, {}), ParameterError);
}

TEST(PartShape, ExtremePointsOfAFineMeshMissNothingThatMatters)
{
  const PartShape ball = makePartShape(sphereMesh(0.05f, 6), {});
  EXPECT_LE(ball.extreme_points.size(), 2000u);
  EXPECT_NEAR(ball.diameter, 0.1, 0.0004);  // largestDistance is exact to 0.4 %
  // Turned by 0.1 rad about any axis, the farthest point moves by a chord of the equator.
  const Pose turned(Eigen::AngleAxisd(0.1, Eigen::Vector3d(1, -2, 0.5).normalized()));
  const double chord = 2 * 0.05 * std::sin(0.05);
  EXPECT_NEAR(maximumSymmetryAwareDistance(ball.extreme_points, turned, Pose::Identity(), {}), chord, 0.005 * chord);
}

TEST(GreedyAssignment, BestFirstTakesTheNearestFreeOne)
{
  Eigen::MatrixXd errors(3, 2);
  errors << 2, 1,  //
      3, 1,        // its nearest is taken: the other one
      1, 1;        // both are taken
  const auto assigned = assignGreedily(errors, {5, 5, 5});
  EXPECT_EQ(assigned[0], 1u);
  EXPECT_EQ(assigned[1], 0u);
  EXPECT_FALSE(assigned[2]);
  EXPECT_FALSE(assignGreedily(errors, {1, 1, 1})[0]) << "an error equal to the limit is not below it";
  EXPECT_TRUE(assignGreedily(Eigen::MatrixXd(0, 0), {}).empty());
  EXPECT_FALSE(assignGreedily(Eigen::MatrixXd(1, 0), {5})[0]);
}

TEST(Judgement, PerfectPosesAreRightWithoutError)
{
  const JudgedScene judged = judge(sceneOfBars({1, 1}), {bar(0, 0.5), bar(1, 0.9)});
  EXPECT_EQ(verdicts(judged), (std::vector<Verdict>{Verdict::Right, Verdict::Right}));
  EXPECT_EQ(judged.estimates[0].estimate.score, 0.9) << "best first";
  EXPECT_EQ(judged.found_by[0], 1u);
  EXPECT_EQ(judged.found_by[1], 0u);
  for (const JudgedEstimate& e : judged.estimates)
  {
    EXPECT_NEAR(e.error.translation, 0, 1e-12);
    EXPECT_NEAR(e.error.rotation, 0, 1e-7);
    EXPECT_NEAR(e.max_distance, 0, 1e-9);
    EXPECT_NEAR(e.mean_distance, 0, 1e-6);  // searched in single precision
  }
  EXPECT_EQ(verdictText(judged, 0), "right: 0.00 mm, 0.00 deg");
}

TEST(Judgement, AShiftIsMeasuredAndJudgedByTheDiameter)
{
  const JudgedScene near = judge(sceneOfBars({1}), {bar(0, 1, 0.009)});
  EXPECT_EQ(near.estimates[0].verdict, Verdict::Right);  // 10 % of the diameter are 9.17 mm
  EXPECT_NEAR(near.estimates[0].error.translation, 0.009, 1e-9);
  EXPECT_NEAR(near.estimates[0].max_distance, 0.009, 1e-8);
  EXPECT_LT(near.estimates[0].mean_distance, 0.009);  // the surface slides along itself
  const JudgedScene far = judge(sceneOfBars({1}), {bar(0, 1, 0.0093)});
  EXPECT_EQ(far.estimates[0].verdict, Verdict::Wrong);
  EXPECT_EQ(far.estimates[0].instance, 0u) << "the one that was meant";
  EXPECT_EQ(verdictText(far, 0), "off by 9.3 mm, 0.0 deg");
  EXPECT_FALSE(far.found_by[0]);
  EXPECT_TRUE(far.found_by_mean_distance[0]) << "ADD-S is more lenient";
  EvaluationParameters lenient;
  lenient.max_error_share = 0.2;
  EXPECT_EQ(judge(sceneOfBars({1}), {bar(0, 1, 0.0093)}, lenient).estimates[0].verdict, Verdict::Right);
}

TEST(Judgement, ASymmetricEquivalentIsAsRight)
{
  PoseEstimate estimate = bar(0, 1, 0.002);
  estimate.T_camera_object = estimate.T_camera_object * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ());
  const JudgedScene judged = judge(sceneOfBars({1}), {estimate});
  EXPECT_EQ(judged.estimates[0].verdict, Verdict::Right);
  EXPECT_NEAR(judged.estimates[0].error.translation, 0.002, 1e-9);
  EXPECT_NEAR(judged.estimates[0].error.rotation, 0, 1e-7);
  EXPECT_NEAR(judged.estimates[0].max_distance, 0.002, 1e-8);

  // About x the bar looks the same too, but nobody declared that: a gripper made for one side would miss.
  PoseEstimate flipped = bar(0, 1);
  flipped.T_camera_object = flipped.T_camera_object * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX());
  const JudgedScene wrong = judge(sceneOfBars({1}), {flipped});
  EXPECT_EQ(wrong.estimates[0].verdict, Verdict::Wrong);
  EXPECT_EQ(verdictText(wrong, 0), "off by 0.0 mm, 180.0 deg");
}

/// The bar turned about its long axis, x, with what it says of that.
PoseEstimate turnedBar(double angle, const std::optional<UndeterminedTurn>& says)
{
  PoseEstimate estimate = bar(0, 1);
  estimate.T_camera_object = estimate.T_camera_object * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX());
  estimate.undetermined_turn = says;
  return estimate;
}

UndeterminedTurn openTurn(const Eigen::Vector3d& axis, const std::vector<double>& angles = {})
{
  return {{axis, Eigen::Vector3d::Zero()}, angles, 0.001};
}

TEST(Judgement, AnOpenTurnIsNoErrorOfAPoseThatSaysSo)
{
  const auto verdictOf = [](double angle, const std::optional<UndeterminedTurn>& says) {
    return judge(sceneOfBars({1}), {turnedBar(angle, says)}).estimates[0].verdict;
  };
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  EXPECT_EQ(verdictOf(1, std::nullopt), Verdict::Wrong);
  EXPECT_EQ(verdictOf(1, openTurn(x)), Verdict::Right);
  EXPECT_EQ(verdictOf(1, openTurn(-x)), Verdict::Right);
  EXPECT_EQ(verdictOf(M_PI + 1, openTurn(x)), Verdict::Right) << "turn and symmetry together";
  EXPECT_EQ(verdictOf(1, openTurn(Eigen::Vector3d::UnitY())), Verdict::Wrong) << "it claims another axis";
  EXPECT_EQ(verdictOf(1, openTurn(x, {0.5, 2 * M_PI - 1})), Verdict::Right);
  EXPECT_EQ(verdictOf(1, openTurn(x, {0.5, 3})), Verdict::Wrong) << "of these turns none is the true one";
  EXPECT_EQ(verdictOf(0, openTurn(x, {0.5, 3})), Verdict::Right) << "it may be right as it is";

  const JudgedScene judged = judge(sceneOfBars({1}), {turnedBar(1, openTurn(x))});
  EXPECT_NEAR(judged.estimates[0].max_distance, 0, 1e-8);
  EXPECT_NEAR(judged.estimates[0].mean_distance, 0, 1e-6);
  EXPECT_NEAR(judged.estimates[0].error.rotation, 0, 1e-7);
  EXPECT_EQ(verdictText(judged, 0), "right up to its turn: 0.00 mm, 0.00 deg");
  PoseEstimate aside = turnedBar(1, openTurn(x));
  aside.T_camera_object = Eigen::Translation3d(0.005, 0, 0) * aside.T_camera_object;
  EXPECT_NEAR(judge(sceneOfBars({1}), {aside}).estimates[0].max_distance, 0.005, 1e-8) << "all other errors count";
}

TEST(Judgement, ASecondHitIsADuplicate)
{
  const JudgedScene judged = judge(sceneOfBars({1, 1}), {bar(0, 0.9, 0.004), bar(0, 0.8), bar(1, 0.7)});
  EXPECT_EQ(verdicts(judged), (std::vector<Verdict>{Verdict::Right, Verdict::Duplicate, Verdict::Right}));
  EXPECT_EQ(judged.found_by[0], 0u) << "the better score wins, not the smaller error";
  EXPECT_EQ(judged.estimates[1].instance, 0u);
  EXPECT_EQ(verdictText(judged, 1), "duplicate of #1");
}

TEST(Judgement, HiddenInstancesAreToldApart)
{
  const JudgedScene judged = judge(sceneOfBars({0.5, 0.49}), {bar(0, 0.9), bar(1, 0.8), bar(1, 0.7)});
  EXPECT_EQ(verdicts(judged), (std::vector<Verdict>{Verdict::Right, Verdict::Hidden, Verdict::Duplicate}));
  EXPECT_TRUE(judged.estimates[1].isHit());
  EXPECT_NE(verdictText(judged, 1).find("hidden"), std::string::npos);
}

TEST(Judgement, WhereNoPartIsNoneIsFound)
{
  const JudgedScene judged = judge(sceneOfBars({1}), {bar(1, 0.9), bar(0, 0.8, 0.05)});
  EXPECT_EQ(verdicts(judged), (std::vector<Verdict>{Verdict::Wrong, Verdict::Wrong}));
  EXPECT_EQ(verdictText(judged, 0), "no part there");
  EXPECT_TRUE(std::isnan(judged.estimates[0].max_distance));
  EXPECT_FALSE(judged.estimates[1].instance) << "more than half a diameter away";
}

TEST(Judgement, PartsAreNotConfused)
{
  EvaluationScene scene = sceneOfBars({1});
  scene.parts.push_back("cube");
  const JudgedScene judged = judge(scene, {{"cube", scene.instances[0].T_camera_object, 1}});
  EXPECT_EQ(judged.estimates[0].verdict, Verdict::Wrong);
  EXPECT_EQ(verdictText(judged, 0), "no part there");
}

TEST(Judgement, MillimetresGivenAsMetresAreWrongAndNoAccident)
{
  PoseEstimate estimate = bar(0, 1);
  estimate.T_camera_object.translation() *= 1000;
  const JudgedScene judged = judge(sceneOfBars({1}), {estimate});
  EXPECT_EQ(judged.estimates[0].verdict, Verdict::Wrong);
  EXPECT_EQ(verdictText(judged, 0), "no part there");
  EXPECT_FALSE(judged.found_by_mean_distance[0]);
}

TEST(Judgement, WhatIsNoPoseIsRefused)
{
  const EvaluationScene scene = sceneOfBars({1});
  PoseEstimate mirrored = bar(0, 1);
  mirrored.T_camera_object.linear().col(0) *= -1;
  expectWords(messageOf<ParameterError>([&] { judge(scene, {mirrored}); }), {"mirror image", "bar", "scene"});
  PoseEstimate scaled = bar(0, 1);
  scaled.T_camera_object.linear() *= 1000;
  expectWords(messageOf<ParameterError>([&] { judge(scene, {scaled}); }), {"no rotation", "without scale"});
  PoseEstimate unknown = bar(0, 1);
  unknown.T_camera_object.translation().x() = std::nan("");
  expectWords(messageOf<ParameterError>([&] { judge(scene, {unknown}); }), {"not finite"});
  EXPECT_THROW(judge(scene, {bar(0, std::nan(""))}), ParameterError);
  expectWords(messageOf<ParameterError>([&] { judge(scene, {{"cube", poseAt(0, 0), 1}}); }), {"cube", "search"});
  EXPECT_THROW(judge(sceneOfBars({std::nan("")}), {}), ParameterError);
}

TEST(EvaluationParameters, LevelsAreNumbersInOrder)
{
  EvaluationParameters parameters;
  EXPECT_EQ(parameters.levels(), (std::vector<double>{0.5, 0.85}));
  parameters.visible_levels = "0.9 0.1 0.4";
  EXPECT_EQ(parameters.levels(), (std::vector<double>{0.1, 0.4, 0.9}));
  for (const std::string wrong : {"", "half", "0.5 x", "0", "1.1", "0.5, 0.8"})
  {
    parameters.visible_levels = wrong;
    EXPECT_THROW(parameters.levels(), ParameterError) << wrong;
  }
  EXPECT_THROW(setParameter(visitor(parameters), "max_error_share=0"), ParameterError);
}
}  // namespace
}  // namespace bin_picking
