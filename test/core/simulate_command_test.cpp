// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
//
// Runs `bin_picking simulate` as a user does: what it writes, and what it refuses.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "bin_picking_perception/evaluation/evaluation_dataset.hpp"
#include "core/command_runner.hpp"
#include "core/mesh_shapes.hpp"

namespace bin_picking
{
namespace
{
namespace fs = std::filesystem;
using namespace test;
using Json = nlohmann::json;

const std::string PARTS = std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/";
const std::string TUBE = PARTS + "three_way_tube";
const std::string BOLT = PARTS + "hex_bolt";
const std::vector<std::string> SCENE_FILES = {"scene.pcd", "bin.yaml", "camera.json", "truth.json", "scene.png"};

class SimulateCommand : public ::testing::Test
{
protected:
  std::string file(const std::string& name) const { return folder_.path(name); }
  Json readJson(const std::string& name) const { return Json::parse(readFile(file(name))); }

  /// Small pictures keep it quick.
  std::string onTubes(const std::string& options) const { return onParts(TUBE, options); }
  std::string onParts(const std::string& parts, const std::string& options) const
  {
    return "simulate " + parts + " --size 160x128 " + options;
  }
  void expectDone(const std::string& arguments) const
  {
    const Outcome result = runCommand(arguments);
    ASSERT_EQ(result.exit_code, 0) << arguments << "\n" << result.text;
  }
  /// Expects the failure, and that nothing is left of it.
  void expectFailure(const std::string& arguments, int exit_code, const std::vector<std::string>& said) const
  {
    const std::set<std::string> before = content();
    expectCommandFails(arguments, exit_code, said);
    EXPECT_EQ(content(), before) << arguments;
  }
  /// A copy of a demo part whose file may then be changed.
  std::string copyOfPart(const std::string& source, const std::string& name) const
  {
    fs::copy(source, file(name), fs::copy_options::recursive);
    return file(name);
  }

private:
  std::set<std::string> content() const
  {
    std::set<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path("")))
      files.insert(entry.path().string());
    return files;
  }

  TemporaryFolder folder_;
};

std::string replaced(std::string text, const std::string& what, const std::string& with)
{
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), with);
}
}  // namespace

TEST_F(SimulateCommand, writesAScanWithItsTruth)
{
  expectDone(onTubes("--count 4 --seed 3 -o " + file("scene")));
  const Json truth = readJson("scene/truth.json");
  EXPECT_EQ(truth.at("format"), 1);
  EXPECT_EQ(truth.at("seed"), 3);
  EXPECT_EQ(truth.at("sensor"), "structured_light");
  EXPECT_EQ(truth.at("parts"), Json({"three_way_tube"}));
  ASSERT_EQ(truth.at("instances").size(), 4u);
  for (const Json& instance : truth.at("instances"))
  {
    EXPECT_EQ(instance.at("part"), "three_way_tube");
    EXPECT_EQ(instance.at("T_camera_object").at(3), Json({0, 0, 0, 1}));
    EXPECT_NEAR(instance.at("T_camera_object").at(2).at(3).get<double>(), 0.75, 0.08) << "in the bin, 0.8 m away";
    EXPECT_GT(instance.at("visible_fraction").get<double>(), 0.2);
    EXPECT_LE(instance.at("visible_fraction").get<double>(), 1);
    EXPECT_LE(instance.at("valid_pixels").get<int>(), instance.at("visible_pixels").get<int>());
    EXPECT_GT(instance.at("valid_pixels").get<int>(), 50);
  }
  const Json camera = readJson("scene/camera.json");
  EXPECT_EQ(camera.at("width"), 160);
  EXPECT_EQ(camera.at("height"), 128);
  EXPECT_EQ(camera.at("cx").get<double>(), 79.5);
  EXPECT_EQ(camera.at("fx"), camera.at("fy"));
}

TEST_F(SimulateCommand, pictureShowsEachPartInAColourOfItsOwn)
{
  expectDone(onTubes("--count 3 --sensor ideal -o " + file("full")));
  expectDone(onTubes("--empty --sensor ideal -o " + file("empty")));
  const auto coloured = [&](const std::string& name) {
    const cv::Mat picture = cv::imread(file(name));
    EXPECT_EQ(picture.size(), cv::Size(160, 128));
    int count = 0;
    for (int v = 0; v < picture.rows; ++v)
      for (int u = 0; u < picture.cols; ++u)
      {
        const cv::Vec3b& bgr = picture.at<cv::Vec3b>(v, u);
        count += bgr[0] != bgr[1] || bgr[1] != bgr[2];
      }
    return count;
  };
  int visible = 0;
  const Json truth = readJson("full/truth.json");
  for (const Json& instance : truth.at("instances"))
    visible += instance.at("visible_pixels").get<int>();
  EXPECT_NEAR(coloured("full/scene.png"), visible, 0.02 * visible);
  EXPECT_EQ(coloured("empty/scene.png"), 0) << "floor and walls are gray";
}

TEST_F(SimulateCommand, dataSetOfSeveralScenesAndPartsCanBeEvaluated)
{
  expectDone(onParts(TUBE + " " + BOLT, "--count 2 3 --scenes 2 --seed 10 -o " + file("bins")));
  const EvaluationDataset dataset = openDataset(file("bins"), {});
  ASSERT_EQ(dataset.scenes.size(), 2u);
  ASSERT_EQ(dataset.parts.size(), 2u);
  EXPECT_EQ(dataset.scenes[0].name, "scene_0001");
  for (const EvaluationPart& part : dataset.parts)
    EXPECT_EQ(part.definition.directory, file("bins/parts/" + part.definition.name)) << "parts come with the data set";
  for (const EvaluationScene& scene : dataset.scenes)
  {
    EXPECT_TRUE(scene.bin.has_value());
    EXPECT_EQ(std::count_if(scene.instances.begin(), scene.instances.end(),
                            [](const TrueInstance& instance) { return instance.part == "hex_bolt"; }),
              3);
    EXPECT_EQ(scene.instances.size(), 5u);
    EXPECT_EQ(loadSceneGrid(scene, {}).width, 160);
  }
  EXPECT_EQ(readJson("bins/scene_0001/truth.json").at("seed"), 10);
  EXPECT_EQ(readJson("bins/scene_0002/truth.json").at("seed"), 11);
  EXPECT_NE(readFile(file("bins/scene_0001/truth.json")), readFile(file("bins/scene_0002/truth.json")));
}

TEST_F(SimulateCommand, sceneDependsOnTheSeedAndNothingElse)
{
  expectDone(onTubes("--count 5 --threads 1 -o " + file("one")));
  expectDone(onTubes("--count 5 --threads 3 --seed 1 -o " + file("two")));
  expectDone(onTubes("--count 5 --seed 2 -o " + file("three")));
  for (const std::string& name : SCENE_FILES)
    EXPECT_EQ(readFile(file("one/" + name)), readFile(file("two/" + name))) << name;
  for (const std::string name : {"scene.pcd", "truth.json", "scene.png"})
    EXPECT_NE(readFile(file("one/" + name)), readFile(file("three/" + name))) << name;
}

TEST_F(SimulateCommand, countInAllIsSharedOut)
{
  expectDone(onParts(TUBE + " " + BOLT, "--count 3 -o " + file("scene")));
  std::multiset<std::string> parts;
  const Json truth = readJson("scene/truth.json");
  for (const Json& instance : truth.at("instances"))
    parts.insert(instance.at("part").get<std::string>());
  EXPECT_EQ(parts.count("three_way_tube"), 2u);
  EXPECT_EQ(parts.count("hex_bolt"), 1u);
}

TEST_F(SimulateCommand, emptyBinAndOtherSensors)
{
  expectDone(onTubes("--empty --sensor stereo -o " + file("empty")));
  const Json truth = readJson("empty/truth.json");
  EXPECT_EQ(truth.at("sensor"), "stereo");
  EXPECT_EQ(truth.at("parts"), Json({"three_way_tube"})) << "searched for, though none is there";
  EXPECT_TRUE(truth.at("instances").empty());
}

TEST_F(SimulateCommand, wrongUsageIsToldInASentence)
{
  const std::string out = " -o " + file("new/scene");
  expectFailure(onTubes("--sensor nonsense" + out), 2, {"sensor/type", "nonsense", "structured_light, stereo, ideal"});
  expectFailure(onTubes("--count 0" + out), 2, {"0 parts in all", "[1, 60]", "--empty"});
  expectFailure(onTubes("--count 61" + out), 2, {"--count", "'61'", "[0, 60]"});
  expectFailure(onTubes("--count two" + out), 2, {"--count", "'two'"});
  expectFailure(onTubes("--count 2 3" + out), 2, {"2 numbers for 1 part;"});
  expectFailure(onParts(TUBE + " " + BOLT, "--count 40 40" + out), 2, {"80 parts in all", "[1, 60]"});
  expectFailure(onTubes("--count 2 --empty" + out), 2, {"--empty", "--count", "exclude"});
  expectFailure(onTubes("--scenes 0" + out), 2, {"--scenes", "'0'"});
  expectFailure(onParts(TUBE + " " + TUBE, out), 2, {"'three_way_tube' was given twice"});
  expectFailure(onTubes("--set layout/bin_lenght=0.5" + out), 2, {"bin_lenght", "did you mean 'layout/bin_length'"});
  expectFailure(onTubes("--set layout/bin_length=-1" + out), 2, {"layout/bin_length", "-1", "[0.05, 2] m"});
  expectFailure("simulate " + TUBE, 2, {"'-o DIR' is missing"});
}

TEST_F(SimulateCommand, binTooSmallForThePartOrForAllIsTold)
{
  const std::string out = " -o " + file("scene");
  expectFailure(onTubes("--set layout/bin_length=0.06 layout/bin_width=0.06" + out), 2,
                {"'three_way_tube' is too large for the bin", "60 mm x 60 mm"});
  const std::string flat = "--set layout/bin_length=0.1 layout/bin_width=0.05 layout/bin_height=0.02";
  expectFailure(onParts(BOLT, "--count 20 " + flat + out), 2, {"the bin is too full", "20 parts"});
}

TEST_F(SimulateCommand, unfitPartsAreTold)
{
  const std::string out = " -o " + file("scene");
  expectFailure(onParts(file("no_such_part"), out), 1, {"no_such_part"});

  const std::string yaml = readFile(BOLT + "/part.yaml");
  const std::string open = copyOfPart(BOLT, "open");
  TriangleMesh lid = box(30, 20, 10);
  lid.triangles.pop_back();
  std::ofstream(open + "/hex_bolt.stl", std::ios::binary) << binaryStl(lid, "open box");
  std::ofstream(open + "/part.yaml") << "format: 1\nname: lid\nmesh: {file: hex_bolt.stl, unit: mm}\n";
  expectFailure(onParts(open, out), 2, {"part 'lid'", "not closed", "3 of its edges"});

  const std::string outside = copyOfPart(BOLT, "outside");
  fs::rename(outside + "/hex_bolt.stl", file("hex_bolt.stl"));
  std::ofstream(outside + "/part.yaml") << replaced(yaml, "hex_bolt.stl", "../hex_bolt.stl");
  expectFailure(onParts(outside, out), 1, {"hex_bolt.stl' lies outside the folder of the part 'hex_bolt'", "move it"});

  const std::string strange = copyOfPart(BOLT, "strange");
  std::ofstream(strange + "/part.yaml") << replaced(yaml, "name: hex_bolt", "name: ../bolt");
  expectFailure(onParts(strange, out), 1, {"'../bolt' cannot be that of a folder"});
}

TEST_F(SimulateCommand, partIsCopiedWithAllThatItsFileNames)
{
  const std::string part = copyOfPart(BOLT, "bolt");
  fs::create_directories(part + "/meshes");
  fs::rename(part + "/hex_bolt.stl", part + "/meshes/bolt.stl");
  fs::remove(part + "/part.yaml");
  std::ofstream(part + "/m10.yaml") << "format: 1\nname: bolt\nmesh: {file: meshes/bolt.stl, unit: mm}\n"
                                       "symmetry: {models_info: {file: models_info.json, id: 1}}\n";
  std::ofstream(part + "/models_info.json")
      << R"({"1": {"diameter": 98.8, "min_x": -9, "min_y": -9, "min_z": 0, "size_x": 18, "size_y": 18, "size_z": 90}})";
  expectDone(onParts(part + "/m10.yaml", "--count 1 -o " + file("scene")));
  fs::remove_all(part);
  const EvaluationDataset dataset = openDataset(file("scene"), {});
  EXPECT_EQ(dataset.parts.at(0).definition.mesh_file, file("scene/parts/bolt/meshes/bolt.stl"));
  EXPECT_TRUE(fs::exists(file("scene/parts/bolt/models_info.json")));
}

TEST_F(SimulateCommand, onlyItsOwnOutputIsReplaced)
{
  expectDone(onTubes("--count 2 --scenes 2 -o " + file("bins")));
  expectDone(onTubes("--count 2 -o " + file("bins/")));
  EXPECT_TRUE(fs::exists(file("bins/scene.pcd")));
  EXPECT_FALSE(fs::exists(file("bins/scene_0001"))) << "replaced as a whole";

  std::ofstream(file("bins/notes.txt")) << "do not lose me";
  expectFailure(onTubes("--count 2 -o " + file("bins")), 1, {"bins' exists", "other things", "another folder"});
  EXPECT_EQ(readFile(file("bins/notes.txt")), "do not lose me");

  fs::create_directories(file("measured"));
  fs::copy(file("bins/scene.pcd"), file("measured/scene.pcd"));
  std::ofstream(file("measured/truth.json")) << R"({"format": 1, "parts": [], "instances": []})";
  expectFailure(onTubes("--count 2 -o " + file("measured")), 1, {"exists"});

  fs::create_directories(file("free"));
  expectDone(onTubes("--count 2 -o " + file("free")));
}

TEST_F(SimulateCommand, placeThatCannotBeWrittenIsTold)
{
  std::ofstream(file("occupied")) << "a file";
  expectFailure(onTubes("--count 2 -o " + file("occupied")), 1, {"occupied' exists"});
  expectFailure(onTubes("--count 2 -o " + file("occupied/scene")), 1, {"cannot make the folder", "occupied/scene"});
  EXPECT_EQ(readFile(file("occupied")), "a file");
}
}  // namespace bin_picking
