// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
//
// A shaft whose keyway is seen is known in full; seen from behind, all of it is known but its turn, and it says so.
#include "bin_picking_perception/model/undetermined_turn.hpp"

#include <gtest/gtest.h>

#include "bin_picking_perception/detector.hpp"
#include "core/command_runner.hpp"
#include "core/dataset_folders.hpp"
#include "core/shaft_scene.hpp"

namespace bin_picking
{
namespace
{
using namespace test;

constexpr double DEGREE = M_PI / 180;
constexpr double SIGMA = 0.0001;
constexpr double HIDDEN = 165 * DEGREE;  // the keyway below, and not just on a step of the near symmetries

DetectionResult detect(const std::shared_ptr<const TrainedModel>& model, const Pose& truth,
                       const DetectorParameters& parameters = {})
{
  Detector::Request request;
  request.bin = wideBin();
  return Detector({model}, parameters).detect(renderParts(model->mesh, {truth}, SIGMA), request);
}

/// Within a tenth of the keyway's depth, and what that is over half the length.
void expectAxis(const Pose& estimate, const Pose& truth)
{
  EXPECT_LT((estimate * shaftModel()->center - truth * shaftModel()->center).norm(), 0.0005);
  EXPECT_LT(tiltBetween(estimate, truth), 0.5 * DEGREE);
}

TEST(UndeterminedTurn, AKeywayInViewTellsTheTurn)
{
  for (const double turn : {0.0, 25.0, -40.0})
  {
    const Pose truth = shaftPose(turn * DEGREE);
    const DetectionResult result = detect(shaftModel(), truth);
    ASSERT_EQ(result.detections.size(), 1u) << result.message;
    const Detection& detection = result.detections[0];
    EXPECT_FALSE(detection.undetermined_turn);
    expectAxis(detection.T_camera_object, truth);
    EXPECT_LT(turnBetween(detection.T_camera_object, truth), 5 * DEGREE);
  }
}

TEST(UndeterminedTurn, SeenFromBehindAllButTheTurnIsKnown)
{
  const Pose truth = shaftPose(HIDDEN);
  const DetectionResult result = detect(shaftModel(), truth);
  ASSERT_EQ(result.detections.size(), 1u) << result.message;
  const Detection& detection = result.detections[0];
  expectAxis(detection.T_camera_object, truth);
  ASSERT_TRUE(detection.undetermined_turn);
  EXPECT_GT(detection.undetermined_turn->axis.direction.z(), 0.9999);
  EXPECT_TRUE(detection.undetermined_turn->angles.empty());
  EXPECT_GT(detection.score, 0.9) << "it is sure of what it claims";
  const Pose turned =
      nearestTurned(detection.T_camera_object, truth, *detection.undetermined_turn, shaftModel()->symmetry);
  EXPECT_LT(turnBetween(turned, truth), 0.5 * DEGREE);
  expectWords(result.message, {"the turn of 1 of them is not known"});
}

TEST(UndeterminedTurn, WhoAcceptsNoneGetsAnAmbiguousPose)
{
  DetectorParameters strict;
  strict.verification.accept_undetermined_turns = false;
  const DetectionResult result = detect(shaftModel(), shaftPose(HIDDEN), strict);
  EXPECT_TRUE(result.detections.empty());
  ASSERT_FALSE(result.rejected.empty());
  expectWords(result.rejected[0].rejection, {"turn_margin is"});
  EXPECT_FALSE(result.rejected[0].undetermined_turn);
}

namespace
{
constexpr float HALF_HIDDEN = 0.002f;

/// The run lies across the view; the branch points aside, and where a plate hides half of the tee, it may as well point
/// away from the camera, where the run hides it.
/// \param hidden_from beyond this y (metres) a plate hides what there is
DetectionResult detectTee(float hidden_from)
{
  Pose truth = Pose::Identity();
  truth.translation().z() = 0.6;
  truth.rotate(Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX()));
  DepthRenderer renderer(480, 384, smallCamera());
  renderer.draw(floorMesh(), Pose::Identity(), 0);
  renderer.draw(teeModel()->mesh, truth, 1);
  TriangleMesh plate;
  plate.vertices = {{-0.1f, hidden_from, 0.52f}, {0.1f, hidden_from, 0.52f}, {0.1f, 0.1f, 0.52f}, {-0.1f, 0.1f, 0.52f}};
  plate.triangles = {{0, 1, 2}, {0, 2, 3}};
  renderer.draw(plate, Pose::Identity(), 2);
  Detector::Request request;
  request.bin = wideBin();
  return Detector({teeModel()}, {}).detect(renderer.grid(), request);
}
}  // namespace

TEST(UndeterminedTurn, AHiddenBranchIsMoreThanATurn)
{
  const DetectionResult result = detectTee(HALF_HIDDEN);
  EXPECT_TRUE(result.detections.empty()) << result.message;
  bool ambiguous = false;
  for (const Detection& rejected : result.rejected)
  {
    EXPECT_FALSE(rejected.undetermined_turn) << rejected.rejection;
    ambiguous = ambiguous || rejected.rejection.find("turn_margin is") == 0;
  }
  EXPECT_TRUE(ambiguous) << result.message;
}

TEST(UndeterminedTurn, HalfAMarginIsEnoughWhereAllElseIsSure)
{
  const double margin = VerificationParameters().min_turn_margin;
  int sure = 0;
  int unsure = 0;
  for (const float hidden_from : {-0.008f, -0.004f, HALF_HIDDEN, 0.09f})
  {
    const DetectionResult result = detectTee(hidden_from);
    for (const auto* poses : {&result.detections, &result.rejected})
      for (const Detection& detection : *poses)
        for (const Criterion& criterion : detection.criteria)
          if (criterion.name == "turn_margin")
          {
            EXPECT_EQ(criterion.required, detection.score >= 0.96 ? margin / 2 : margin) << detection.score;
            (detection.score >= 0.96 ? sure : unsure) += 1;
          }
  }
  EXPECT_GT(sure, 0);
  EXPECT_GT(unsure, 0);
}

TEST(UndeterminedTurn, ProgramsAreToldIt)
{
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path("bins/parts"));
  std::filesystem::copy(partFolder("stepped_shaft"), folder.path("bins/parts/stepped_shaft"));
  for (const auto& [name, turn] : {std::make_pair("bins/hidden", HIDDEN), std::make_pair("bins/seen", 0.0)})
  {
    std::filesystem::create_directories(folder.path(name));
    Json truth = truthOf({"stepped_shaft"}, {});
    truth["instances"].push_back(
        {{"part", "stepped_shaft"}, {"T_camera_object", rowsOf(shaftPose(turn))}, {"visible_fraction", 1}});
    folder.write(std::string(name) + "/truth.json", truth.dump());
    saveGrid(renderParts(shaftModel()->mesh, {shaftPose(turn)}, SIGMA), folder.path(std::string(name) + "/scene.pcd"));
  }
  saveModel(*shaftModel(), folder.path("shaft.model"));

  const Outcome found = runCommand("detect --model " + folder.path("shaft.model") + " --cloud " +
                                   folder.path("bins/hidden/scene.pcd") + " --json " + folder.path("found.json"));
  ASSERT_EQ(found.exit_code, 0) << found.text;
  expectWords(found.text, {"#1: its turn about the axis z through (", "is not known"});
  const Json detection = Json::parse(readFile(folder.path("found.json"))).at("detections").at(0);
  const Json& open = detection.at("undetermined_turn");
  EXPECT_NEAR(open.at("axis").at("direction").at(2).get<double>(), 1, 1e-4);
  EXPECT_EQ(open.at("axis").at("origin").size(), 3u);
  EXPECT_TRUE(open.at("angles").empty());
  EXPECT_NEAR(open.at("deviation").get<double>(), 0.005, 0.0005);
  expectWords(open.at("text").get<std::string>(), {"its turn about the axis z"});

  const std::string evaluate = "evaluate --dataset " + folder.path("bins") + " --model " + folder.path("shaft.model") +
                               " --csv " + folder.path("found.csv") + " --json ";
  const Outcome judged = runCommand(evaluate + folder.path("judged.json"));
  ASSERT_EQ(judged.exit_code, 0) << judged.text;
  expectWords(judged.text, {"stepped_shaft, some of whose poses leave a turn open", "found with their turn, 85%"});
  const Json figures = Json::parse(readFile(folder.path("judged.json"))).at("all");
  EXPECT_EQ(figures.at("recall").at(1).at("hits"), 2);
  EXPECT_EQ(figures.at("recall").at(1).at("turn_known").at("hits"), 1);
  EXPECT_EQ(figures.at("undetermined_turns").at("hits"), 1);
  EXPECT_EQ(figures.at("undetermined_turns").at("total"), 1);

  // The results format of BOP has no place for it: read back, the pose claims its turn.
  const Outcome strict = runCommand("evaluate --dataset " + folder.path("bins") + " --results " +
                                    folder.path("found.csv") + " --json " + folder.path("strict.json"));
  ASSERT_EQ(strict.exit_code, 0) << strict.text;
  const Json again = Json::parse(readFile(folder.path("strict.json"))).at("all");
  EXPECT_EQ(again.at("undetermined_turns").at("total"), 0);
}
}  // namespace
}  // namespace bin_picking
