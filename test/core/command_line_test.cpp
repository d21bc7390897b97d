// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
//
// Runs the executable as a user does, and holds exit codes, messages and the JSON form against what is promised.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "bin_picking_perception/model/mesh.hpp"
#include "core/command_runner.hpp"

namespace bin_picking
{
namespace
{
namespace fs = std::filesystem;
using namespace test;

const std::string TUBE = std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/three_way_tube";

nlohmann::json readJson(const fs::path& path)
{
  std::ifstream file(path);
  return nlohmann::json::parse(file);
}

Pose poseFrom(const nlohmann::json& rows)
{
  Pose T;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      T(row, column) = rows.at(static_cast<std::size_t>(row)).at(static_cast<std::size_t>(column)).get<double>();
  return T;
}

/// Distance of the middles and angle, the tube's half turn about z considered.
std::pair<double, double> tubeError(const Pose& estimate, const Pose& truth)
{
  const Eigen::Matrix3d half_turn = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Matrix3d turn = truth.linear().transpose() * estimate.linear();
  const double angle = std::min(Eigen::AngleAxisd(turn).angle(), Eigen::AngleAxisd(turn * half_turn).angle());
  return {(estimate.translation() - truth.translation()).norm(), angle};
}

/// A scene and a model, made once for all tests.
class CommandLine : public ::testing::Test
{
protected:
  static void SetUpTestSuite()
  {
    folder_ = fs::path(testing::TempDir()) / ("bin_picking_command_line_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    made_scene_ = runCommand("simulate " + TUBE + " --count 6 --size 800x640 -o " + (folder_ / "scene").string());
    made_model_ = runCommand("train " + TUBE + " --leaf 4mm -o " + model());
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static std::string model() { return (folder_ / "tube.model").string(); }
  static std::string file(const std::string& name) { return (folder_ / name).string(); }
  static std::string detectScene(const std::string& options)
  {
    return "detect --model " + model() + " --cloud " + file("scene/scene.pcd") + " --bin " + file("scene/bin.yaml") +
           " " + options;
  }

  static fs::path folder_;
  static Outcome made_scene_;
  static Outcome made_model_;
};

fs::path CommandLine::folder_;
Outcome CommandLine::made_scene_;
Outcome CommandLine::made_model_;

TEST(Usage, HelpAndVersionSucceed)
{
  EXPECT_EQ(runCommand("--help").exit_code, 0);
  const Outcome version = runCommand("--version");
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.text, std::string("bin_picking ") + BIN_PICKING_VERSION + "\n");
  for (const std::string command : {"train", "detect", "match", "evaluate", "grasps", "simulate", "parameters"})
  {
    const Outcome help = runCommand(command + " --help");
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_NE(help.text.find("example: bin_picking " + command), std::string::npos) << help.text;
  }
}

TEST(Usage, WrongUsageIsToldApartFromFailure)
{
  expectCommandFails("", 2, {"usage: bin_picking"});
  expectCommandFails("detct", 2, {"did you mean 'detect'"});
  expectCommandFails("detect --modle a --cloud b", 2, {"unknown option '--modle'", "did you mean '--model'"});
  expectCommandFails("detect --model a", 2, {"'--cloud FILE.pcd' is missing"});
  expectCommandFails("detect --cloud b --model", 2, {"'--model' needs a value"});
  expectCommandFails("detect --model a --cloud b --cloud c", 2, {"given twice"});
  expectCommandFails("detect --model a --cloud b --threads two", 2, {"--threads", "'two'", "whole number"});
  expectCommandFails("detect --model a --cloud b --preset quick", 2, {"quick", "fast"});
  expectCommandFails("detect --model a --cloud b extra", 2, {"superfluous argument 'extra'"});
  expectCommandFails("parameters --markdown=yes", 2, {"takes no value"});
  expectCommandFails("train", 2, {"PART_DIR|MESH is missing"});
  expectCommandFails("train part.stl", 2, {"--unit"});
  expectCommandFails("train part.stl --unit furlong", 2, {"furlong", "mm"});
  expectCommandFails("train " + TUBE + " --set laef=3mm", 2, {"laef", "did you mean 'leaf'"});
  expectCommandFails("train " + TUBE + " --unit inch", 2, {"part.yaml", "mm"});
  expectCommandFails("simulate " + TUBE + " --size big -o x", 2, {"WIDTHxHEIGHT"});
}

TEST(Usage, MissingFilesAreFailuresThatNameTheFile)
{
  expectCommandFails("detect --model no_such.model --cloud b.pcd", 1, {"no_such.model"});
  expectCommandFails("match --model no_such.model --points b.ply --unit mm", 1, {"no_such.model"});
  expectCommandFails("train no_such.stl --unit mm", 1, {"no_such.stl"});
  expectCommandFails("simulate no_such_part -o x", 1, {"no_such_part"});
  expectCommandFails("detect --model a --cloud b --config no_such.yaml", 1, {"no_such.yaml"});
}

TEST(Usage, ParametersOfEveryPresetAreListedWithTheirEffect)
{
  for (const std::string preset : {"paper", "fast", "accurate"})
  {
    const Outcome table = runCommand("parameters --markdown --preset " + preset);
    EXPECT_EQ(table.exit_code, 0);
    EXPECT_NE(table.text.find("| `voting/reference_share` |"), std::string::npos) << table.text;
  }
  EXPECT_NE(runCommand("parameters --of train").text.find("leaf:"), std::string::npos);
  EXPECT_NE(runCommand("parameters --of simulate").text.find("depth_noise:"), std::string::npos);
  expectCommandFails("parameters --of grasp", 2, {"detect, train, simulate"});
}

TEST_F(CommandLine, SceneHasItsTruthBesideIt)
{
  ASSERT_EQ(made_scene_.exit_code, 0) << made_scene_.text;
  for (const std::string name : {"scene.pcd", "bin.yaml", "truth.json", "scene.png"})
    EXPECT_GT(fs::file_size(folder_ / "scene" / name), 0u) << name;
  const nlohmann::json truth = readJson(folder_ / "scene/truth.json");
  EXPECT_EQ(truth.at("parts"), nlohmann::json({"three_way_tube"}));
  ASSERT_EQ(truth.at("instances").size(), 6u);
  for (const auto& instance : truth.at("instances"))
  {
    const Pose T = poseFrom(instance.at("T_camera_object"));
    EXPECT_TRUE(T.linear().isUnitary(1e-9));
    EXPECT_NEAR(T.translation().z(), 0.77, 0.1);
    EXPECT_GE(instance.at("visible_fraction").get<double>(), 0);
  }
}

TEST_F(CommandLine, TrainSummarizesThePart)
{
  ASSERT_EQ(made_model_.exit_code, 0) << made_model_.text;
  for (const std::string words : {"three_way_tube", "90.0 x 35.0 x 67.5 mm", "0 open edges", "2 equal attitudes",
                                  "leaf", "pairs", "points where faces end", "MiB"})
    EXPECT_NE(made_model_.text.find(words), std::string::npos) << words << "\n" << made_model_.text;
}

TEST_F(CommandLine, DetectFindsThePartsAndWritesTheFixedForm)
{
  const Outcome found = runCommand(detectScene("--json " + file("found.json") + " --image " + file("found.png")));
  ASSERT_EQ(found.exit_code, 0) << found.text;
  EXPECT_GT(fs::file_size(file("found.png")), 1000u);
  const nlohmann::json json = readJson(file("found.json"));
  EXPECT_EQ(json.at("code"), 0);
  EXPECT_FALSE(json.at("message").get<std::string>().empty());
  EXPECT_EQ(json.at("cloud"), file("scene/scene.pcd"));
  EXPECT_GT(json.at("timing_ms").at("total").get<double>(), 0);
  EXPECT_TRUE(json.at("counts").is_object());
  const nlohmann::json truth = readJson(folder_ / "scene/truth.json");
  int right = 0;
  double score_before = 1;
  for (const auto& detection : json.at("detections"))
  {
    EXPECT_EQ(detection.at("part"), "three_way_tube");
    EXPECT_LE(detection.at("score").get<double>(), score_before) << "best first";
    score_before = detection.at("score").get<double>();
    EXPECT_GT(detection.at("matching_rate").get<double>(), 0);
    EXPECT_GT(detection.at("visible_fraction").get<double>(), 0);
    for (const auto& instance : truth.at("instances"))
    {
      const auto [distance, angle] =
          tubeError(poseFrom(detection.at("T_camera_object")), poseFrom(instance.at("T_camera_object")));
      right += distance < 0.002 && angle < 0.05;
    }
  }
  // Six tubes side by side, hardly covered: most must be found, within a leaf's fraction.
  EXPECT_GE(right, 4);
  EXPECT_GE(right, static_cast<int>(json.at("detections").size()) - 1);
}

TEST_F(CommandLine, ResultDoesNotDependOnTheNumberOfThreads)
{
  ASSERT_EQ(runCommand(detectScene("--threads 1 --json " + file("one.json"))).exit_code, 0);
  ASSERT_EQ(runCommand(detectScene("--threads 3 --json " + file("three.json"))).exit_code, 0);
  EXPECT_EQ(readJson(file("one.json")).at("detections"), readJson(file("three.json")).at("detections"));
}

TEST_F(CommandLine, PrintedParametersCanBeReadBack)
{
  const Outcome printed = runCommand("parameters --preset fast");
  std::ofstream(file("fast.yaml")) << printed.text;
  ASSERT_EQ(runCommand(detectScene("--json " + file("preset.json"))).exit_code, 0);
  const Outcome configured =
      runCommand(detectScene("--config " + file("fast.yaml") + " --json " + file("config.json")));
  ASSERT_EQ(configured.exit_code, 0) << configured.text;
  EXPECT_EQ(readJson(file("preset.json")).at("detections"), readJson(file("config.json")).at("detections"));
}

TEST_F(CommandLine, OneConfigurationServesTrainingAndDetection)
{
  const std::string paper = std::string(BIN_PICKING_SOURCE_DIR) + "/config/paper/three_way_tube.yaml";
  const Outcome detected =
      runCommand(detectScene("--preset paper --config " + paper + " --json " + file("paper.json")));
  ASSERT_EQ(detected.exit_code, 0) << detected.text;
  EXPECT_LE(readJson(file("paper.json")).at("detections").size(), 5u);

  std::ofstream(file("coarse.yaml")) << "training: {leaf: 7mm}\ndetector: {max_detections: 2}\n";
  const Outcome trained =
      runCommand("train " + TUBE + " --config " + file("coarse.yaml") + " -o " + file("coarse.model"));
  ASSERT_EQ(trained.exit_code, 0) << trained.text;
  EXPECT_NE(trained.text.find("7.000 mm"), std::string::npos) << trained.text;
  std::ofstream(file("unknown.yaml")) << "training: {laef: 7mm}\n";
  expectCommandFails(detectScene("--config " + file("unknown.yaml")), 2, {"laef", "did you mean"});
}

TEST_F(CommandLine, NothingFoundIsNoFailure)
{
  ASSERT_EQ(runCommand("simulate " + TUBE + " --empty --size 400x320 -o " + file("empty")).exit_code, 0);
  const Outcome result = runCommand("detect --model " + model() + " --cloud " + file("empty/scene.pcd") + " --bin " +
                                    file("empty/bin.yaml") + " --json " + file("empty.json"));
  EXPECT_EQ(result.exit_code, 0) << result.text;
  const nlohmann::json json = readJson(file("empty.json"));
  EXPECT_NE(json.at("code"), 0);
  EXPECT_TRUE(json.at("detections").empty());
  EXPECT_FALSE(json.at("message").get<std::string>().empty());
}

TEST_F(CommandLine, DamagedInputIsAFailureWithASentence)
{
  std::ofstream(file("broken.model")) << "not a model";
  expectCommandFails("detect --model " + file("broken.model") + " --cloud b.pcd", 1, {"broken.model"});
  std::ofstream(file("broken.pcd")) << "not a cloud";
  expectCommandFails("detect --model " + model() + " --cloud " + file("broken.pcd"), 1, {"broken.pcd"});
  std::ofstream(file("broken.yaml")) << "detector: {voting: {wieght: 2}}\n";
  expectCommandFails(detectScene("--config " + file("broken.yaml")), 2, {"wieght", "did you mean"});
}

TEST_F(CommandLine, MatchFindsAMovedPointSet)
{
  Pose T_camera_object = Pose::Identity();
  T_camera_object.linear() = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  T_camera_object.translation() = Eigen::Vector3d(0.1, -0.05, 0.6);
  const TriangleMesh mesh = loadMesh(TUBE + "/three_way_tube.stl", LengthUnit::Millimetre);
  const OrientedPoints scene = transformed(sampleSurface(mesh, 0.0015, 7), T_camera_object);
  std::ofstream ply(file("scan.ply"));
  ply << "ply\nformat ascii 1.0\nelement vertex " << scene.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float "
         "nz\n"
         "end_header\n";
  for (std::size_t i = 0; i < scene.size(); ++i)
    ply << 1000 * scene.points[i].transpose() << " " << scene.normals[i].transpose() << "\n";
  ply.close();
  const Outcome result = runCommand("match --model " + model() + " --points " + file("scan.ply") +
                                    " --unit mm --scene-is-part --json " + file("match.json"));
  ASSERT_EQ(result.exit_code, 0) << result.text;
  const nlohmann::json json = readJson(file("match.json"));
  ASSERT_FALSE(json.at("detections").empty()) << result.text;
  const auto [distance, angle] =
      tubeError(poseFrom(json.at("detections").at(0).at("T_camera_object")), T_camera_object);
  EXPECT_LT(distance, 0.001);
  EXPECT_LT(angle, 0.02);
}
}  // namespace
}  // namespace bin_picking
