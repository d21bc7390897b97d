// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
//
// Runs `bin_picking evaluate` as a user does, on a small data set that is rendered here.
#include <gtest/gtest.h>

#include <cmath>

#include "core/command_runner.hpp"
#include "core/dataset_folders.hpp"
#include "core/tee_scene.hpp"

namespace bin_picking
{
namespace
{
using namespace test;

const std::string TUBE = std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/three_way_tube";

Outcome run(const std::string& arguments) { return runCommand("evaluate " + arguments); }

void expectFailure(const std::string& arguments, int exit_code, const std::vector<std::string>& said)
{
  expectCommandFails("evaluate " + arguments, exit_code, said);
}

/// Two tubes that lie free on a table, and an empty table; the model is trained by the first run and kept.
class EvaluateCommand : public ::testing::Test
{
protected:
  static void SetUpTestSuite()
  {
    folder_ = std::make_unique<OwnFolder>();
    for (const char* name : {"parts", "full", "empty"})
      std::filesystem::remove_all(folder_->path(name));
    std::filesystem::create_directories(folder_->path("bins/parts"));
    std::filesystem::copy(TUBE, folder_->path("bins/parts/three_way_tube"));
    writeScene("tubes", posesApart(2, 3));
    writeScene("table", {});
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static void writeScene(const std::string& name, const std::vector<Pose>& poses)
  {
    Json truth = truthOf({"three_way_tube"}, {});
    for (const Pose& T : poses)
      truth["instances"].push_back(
          {{"part", "three_way_tube"}, {"T_camera_object", rowsOf(T)}, {"visible_fraction", 1}});
    folder_->writeFile("bins/" + name + "/truth.json", truth.dump());
    folder_->writeFile("bins/" + name + "/bin.yaml",
                       "pose: {position: [0, 0, 0.66], orientation: [1, 0, 0, 0]}\ninner_size: [0.4, 0.3, 0.15]\n");
    saveGrid(renderTees(poses, 0.0002), file("bins/" + name + "/scene.pcd"));
  }

  static std::string file(const std::string& name) { return folder_->path(name); }
  static std::string onBins(const std::string& options)
  {
    return "--dataset " + file("bins") + " --cache " + file("cache") + " " + options;
  }
  static Json readJson(const std::string& name) { return Json::parse(readFile(file(name))); }

  static std::unique_ptr<OwnFolder> folder_;
};

std::unique_ptr<OwnFolder> EvaluateCommand::folder_;

/// The time is that of the whole way from the cloud in memory: its conversion is a stage like the others.
void expectTimesAddUp(const Json& scene, std::size_t runs)
{
  ASSERT_EQ(scene.at("total_ms").size(), runs);
  ASSERT_EQ(scene.at("stages").at(0).at("stage"), "input");
  for (std::size_t k = 0; k < runs; ++k)
  {
    double sum = 0;
    for (const Json& stage : scene.at("stages"))
      sum += stage.at("ms").at(k).get<double>();
    EXPECT_GT(scene.at("stages").at(0).at("ms").at(k), 0);
    EXPECT_NEAR(sum, scene.at("total_ms").at(k).get<double>(), 0.05 * sum);
  }
}

/// Both tubes are among the poses that were tested, and the figures count those that are listed.
void expectCalibrationOfTheTested(const Json& json)
{
  int accepted = 0;
  int right = 0;
  double square = 0;
  double count = 0;
  for (const Json& scene : json.at("scenes"))
    for (const Json& pose : scene.at("tested"))
    {
      accepted += pose.at("accepted").get<bool>() ? 1 : 0;
      right += pose.at("right").get<bool>() ? 1 : 0;
      square += std::pow(pose.at("score").get<double>() - (pose.at("right").get<bool>() ? 1 : 0), 2);
      ++count;
      EXPECT_EQ(pose.at("part"), "three_way_tube");
      EXPECT_EQ(pose.at("terms").at("surface_share"), pose.at("quality").at("surface_share"));
    }
  EXPECT_EQ(accepted, 2);
  EXPECT_GE(right, 2);
  const Json& calibration = json.at("all").at("calibration");
  EXPECT_EQ(calibration.at("tested").at("count"), count);
  EXPECT_NEAR(calibration.at("tested").at("brier_score").get<double>(), square / count, 1e-9);
  EXPECT_EQ(calibration.at("returned").at("count"), 2);
  EXPECT_EQ(calibration.at("tested").at("tenths").size(), 10u);
}

TEST_F(EvaluateCommand, FindsTheTubesAndReportsInEveryForm)
{
  const Outcome outcome = run(onBins("--repeat 2 --json " + file("report.json") + " --csv " + file("found.csv") +
                                     " --html " + file("report.html")));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  expectWords(outcome.text, {"2 scenes, 2 parts in them", "three_way_tube", "95 % interval", "voting", "Brier score"});

  const Json json = readJson("report.json");
  EXPECT_EQ(json.at("format"), 1);
  EXPECT_EQ(json.at("object_ids").at("three_way_tube"), 1);
  const Json& all = json.at("all");
  EXPECT_EQ(all.at("right"), 2);  // free tubes, seen from above with 0.2 mm of noise
  EXPECT_EQ(all.at("recall").at(0).at("hits"), 2);
  EXPECT_EQ(all.at("precision_of_first").at(0).at("total"), 1) << "the empty table has nothing to pick";
  EXPECT_EQ(all.at("empty_scenes_with_false").at("total"), 1);
  EXPECT_LT(all.at("translation_mm").at("median").get<double>(), 1);
  EXPECT_EQ(json.at("timing_ms").at("total").at("count"), 4);  // two runs of two scenes
  ASSERT_EQ(json.at("scenes").size(), 2u);
  EXPECT_EQ(json.at("scenes").at(1).at("name"), "tubes");
  EXPECT_EQ(json.at("scenes").at(1).at("estimates").at(0).at("verdict"), "right");
  expectTimesAddUp(json.at("scenes").at(1), 2);
  expectCalibrationOfTheTested(json);
  EXPECT_GT(json.at("scenes").at(1).at("counts").at("votes"), 0);

  const std::string page = readFile(file("report.html"));
  expectWords(page, {"data:image/jpeg;base64,/9j/", "mark-right", "<b>tubes", "Score against truth"});
  EXPECT_EQ(page.find("http"), std::string::npos);
}

TEST_F(EvaluateCommand, WrittenResultsAreJudgedTheSame)
{
  ASSERT_EQ(run(onBins("--json " + file("ours.json") + " --csv " + file("ours.csv"))).exit_code, 0);
  const Outcome again =
      run("--dataset " + file("bins") + " --results " + file("ours.csv") + " --json " + file("read.json"));
  ASSERT_EQ(again.exit_code, 0) << again.text;
  EXPECT_EQ(again.text.find("Brier"), std::string::npos) << "scores of others need not be probabilities";
  EXPECT_FALSE(readJson("read.json").at("all").contains("calibration"));
  const Json ours = readJson("ours.json").at("all");
  const Json read = readJson("read.json").at("all");
  for (const char* figure : {"right", "wrong", "duplicates", "pickable", "recall", "precision", "average_precision"})
    EXPECT_EQ(ours.at(figure), read.at(figure)) << figure;
}

TEST_F(EvaluateCommand, ThreadsDoNotChangeTheResult)
{
  ASSERT_EQ(run(onBins("--threads 1 --json " + file("one.json"))).exit_code, 0);
  ASSERT_EQ(run(onBins("--threads 3 --json " + file("three.json"))).exit_code, 0);
  EXPECT_EQ(readJson("one.json").at("all"), readJson("three.json").at("all"));
  EXPECT_EQ(readJson("one.json").at("scenes").at(1).at("estimates"),
            readJson("three.json").at("scenes").at(1).at("estimates"));
}

TEST_F(EvaluateCommand, MillimetresAndMirrorsOfOthersAreTold)
{
  const std::string header = "scene_id,im_id,obj_id,score,R,t,time\n";
  folder_->writeFile("metres.csv", header + "1,0,1,0.9,1 0 0 0 1 0 0 0 1,0.1 0.0 0.6,0.5\n");
  const Outcome metres =
      run("--dataset " + file("bins") + " --results " + file("metres.csv") + " --json " + file("m.json"));
  ASSERT_EQ(metres.exit_code, 0) << metres.text;
  EXPECT_EQ(readJson("m.json").at("all").at("wrong"), 1);
  EXPECT_EQ(readJson("m.json").at("timing_ms").at("total").at("median"), 500);
  folder_->writeFile("mirror.csv", header + "1,0,1,0.9,-1 0 0 0 1 0 0 0 1,100 0 600,-1\n");
  expectFailure("--dataset " + file("bins") + " --results " + file("mirror.csv"), 1,
                {"mirror.csv", "line 2", "mirror image"});
  folder_->writeFile("other.csv", header + "48,1,7,0.9,1 0 0 0 1 0 0 0 1,100 0 600,-1\n");
  expectFailure("--dataset " + file("bins") + " --results " + file("other.csv"), 1, {"other.csv", "48/1/7"});
}

TEST_F(EvaluateCommand, WrongUseAndDamageHaveASentence)
{
  expectFailure("", 2, {"--dataset"});
  expectFailure("--dataset " + file("none"), 1, {"none", "not a folder"});
  expectFailure(onBins("--split test"), 2, {"'test'"});
  expectFailure(onBins("--parts bolt"), 2, {"bolt", "three_way_tube"});
  expectFailure(onBins("--visible 2"), 2, {"visible_levels", "(0, 1]"});
  expectFailure(onBins("--max-error 3"), 2, {"max_error_share"});
  expectFailure("--dataset " + file("bins") + " --results x.csv --repeat 3", 2, {"--repeat", "--results"});
  expectFailure(onBins("--json " + file("no_such_folder/report.json")), 1, {"no_such_folder"});
}
}  // namespace
}  // namespace bin_picking
