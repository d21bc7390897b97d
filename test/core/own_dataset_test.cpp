// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/evaluation/evaluation_dataset.hpp"
#include "bin_picking_perception/evaluation/part_shape.hpp"
#include "core/dataset_folders.hpp"

namespace bin_picking
{
namespace
{
using namespace test;

std::string failure(const std::string& path, const DatasetSelection& selection = {})
{
  return messageOf<FileError>([&] { openDataset(path, selection); });
}

TEST(OwnDataset, IsReadAsItWasWritten)
{
  const OwnFolder folder;
  const EvaluationDataset dataset = openDataset(folder.path(""), {});
  ASSERT_EQ(dataset.scenes.size(), 2u);
  EXPECT_EQ(dataset.scenes[0].name, "empty");  // by name
  EXPECT_TRUE(dataset.scenes[0].instances.empty());
  EXPECT_EQ(dataset.scenes[0].parts, std::vector<std::string>{"bar"}) << "searched for although it is not there";
  const EvaluationScene& full = dataset.scenes[1];
  EXPECT_EQ(full.name, "full");
  EXPECT_EQ(full.scene_id, 1);
  EXPECT_FALSE(full.bin);
  ASSERT_EQ(full.instances.size(), 1u);
  EXPECT_TRUE(full.instances[0].T_camera_object.isApprox(barPose(), 1e-12));
  EXPECT_EQ(full.instances[0].visible_fraction, 0.93);
  EXPECT_EQ(full.instances[0].visible_pixels, 500);
  EXPECT_EQ(full.instances[0].valid_pixels, 450);
  ASSERT_EQ(dataset.parts.size(), 1u);
  EXPECT_EQ(dataset.parts[0].definition.name, "bar");
  EXPECT_EQ(dataset.parts[0].object_id, 1);
  const DepthGrid grid = loadSceneGrid(full, {});
  EXPECT_EQ(grid.width, 160);
  EXPECT_NEAR(grid.camera.fx, 300, 1e-2);  // fitted to single precision points
}

TEST(OwnDataset, OneSceneIsADataSetToo)
{
  const OwnFolder folder;
  for (const std::string path : {"full", "full/"})
  {
    const EvaluationDataset dataset = openDataset(folder.path(path), {});
    ASSERT_EQ(dataset.scenes.size(), 1u);
    EXPECT_EQ(dataset.scenes[0].name, "full");
    EXPECT_EQ(dataset.parts.size(), 1u) << "from the parts beside it";
  }
}

TEST(OwnDataset, TheBinIsReadWhereThereIsOne)
{
  const OwnFolder folder;
  folder.writeFile("full/bin.yaml",
                   "pose: {position: [0, 0, 0.8], orientation: [1, 0, 0, 0]}\ninner_size: [0.4, 0.3, 0.1]\n");
  EXPECT_NEAR(openDataset(folder.path(""), {}).scenes[1].bin.value().inner_size.x(), 0.4, 1e-12);
}

TEST(OwnDataset, SelectionRestrictsScenesAndParts)
{
  const OwnFolder folder;
  folder.writeFile("mixed/truth.json", truthOf({"bar", "nut"}, {barPose()}).dump());
  saveGrid(barScan(barPose()), folder.path("mixed/scene.pcd"));
  expectWords(failure(folder.path("")), {"nut", "part.yaml", "--parts"});
  const EvaluationDataset bars = openDataset(folder.path(""), {"", {"bar"}, 0});
  EXPECT_EQ(bars.scenes.size(), 3u);
  EXPECT_EQ(bars.scenes[2].parts, std::vector<std::string>{"bar"});
  EXPECT_EQ(openDataset(folder.path(""), {"", {"bar"}, 1}).scenes.size(), 1u);
  expectWords(messageOf<ParameterError>([&] {
                openDataset(folder.path(""), {"", {"bolt"}, 0});
              }),
              {"bolt", "bar, nut"});
  expectWords(messageOf<ParameterError>([&] { openDataset(folder.path(""), {"val", {}, 0}); }), {"val", "split"});

  // A folder of a part replaces that of the data set.
  folder.writeFile("mine/part.yaml", "format: 1\nname: bar\nmesh: {file: ../parts/bar/bar.stl, unit: m}\n");
  const EvaluationDataset mine = openDataset(folder.path("full"), {"", {folder.path("mine")}, 0});
  EXPECT_TRUE(mine.parts[0].definition.symmetry.trivial());
}

TEST(OwnDataset, PosesAreHeldToTheSymmetryThatTrainingFindsWhereNoneIsStated)
{
  const OwnFolder folder;
  const std::string mesh = "format: 1\nname: bar\nmesh: {file: ../parts/bar/bar.stl, unit: m}\n";
  folder.writeFile("unsaid/part.yaml", mesh);
  const auto shapeOf = [&](const std::string& part) {
    return loadPartShapes(openDataset(folder.path("full"), {"", {folder.path(part)}, 0}), Executor()).at("bar");
  };
  EXPECT_EQ(shapeOf("unsaid").symmetry.discrete.size(), 4u) << "half turns about the three axes of a cuboid";
  folder.writeFile("said/part.yaml", mesh + "symmetry: {discrete: [{axis: [0, 0, 1], order: 2, origin: [0, 0, 0]}]}\n");
  EXPECT_EQ(shapeOf("said").symmetry.discrete.size(), 2u);
}

TEST(OwnDataset, DamageIsToldBeforeAnyWork)
{
  const OwnFolder folder;
  std::filesystem::remove(folder.path("full/scene.pcd"));
  expectWords(failure(folder.path("")), {"full", "scene.pcd"});
  folder.writeScene("full", {barPose()});
  std::filesystem::remove(folder.path("full/truth.json"));
  expectWords(failure(folder.path("")), {"full", "truth.json"});
  folder.writeFile("full/truth.json", "{\"format\": 1, ");
  expectWords(failure(folder.path("")), {"truth.json", "JSON"});
  folder.writeFile("full/truth.json", "{\"format\": 2}");
  expectWords(failure(folder.path("")), {"format 2", "format 1"});
  folder.writeFile("full/truth.json", "{\"part\": \"bar\", \"instances\": []}");
  expectWords(failure(folder.path("")), {"truth.json", "format"});
  folder.writeFile("full/truth.json", truthOf({}, {barPose()}).dump());
  expectWords(failure(folder.path("")), {"bar", "parts"});
}

TEST(OwnDataset, APoseThatIsNoMotionIsRefused)
{
  const OwnFolder folder;
  Pose mirrored = barPose();
  mirrored.linear().col(0) *= -1;
  folder.writeFile("full/truth.json", truthOf({"bar"}, {mirrored}).dump());
  expectWords(failure(folder.path("")), {"instance 0", "truth.json", "mirror image"});
  Pose scaled = barPose();
  scaled.linear() *= 1.1;
  folder.writeFile("full/truth.json", truthOf({"bar"}, {scaled}).dump());
  expectWords(failure(folder.path("")), {"no rotation"});
  Json truth = truthOf({"bar"}, {barPose()});
  truth["instances"][0]["T_camera_object"].erase(3);
  folder.writeFile("full/truth.json", truth.dump());
  EXPECT_FALSE(failure(folder.path("")).empty());
  truth = truthOf({"bar"}, {barPose()});
  truth["instances"][0]["visible_fraction"] = 93;
  folder.writeFile("full/truth.json", truth.dump());
  expectWords(failure(folder.path("")), {"visible_fraction", "[0, 1]"});
}

TEST(OwnDataset, AScanOfAnotherSizeIsRefused)
{
  const OwnFolder folder;
  folder.writeFile("full/camera.json",
                   "{\"width\": 160, \"height\": 121, \"fx\": 300, \"fy\": 310, \"cx\": 1, \"cy\": 1}");
  const EvaluationDataset dataset = openDataset(folder.path("full"), {});
  expectWords(messageOf<FileError>([&] { loadSceneGrid(dataset.scenes[0], {}); }),
              {"scene.pcd", "160 x 120", "160 x 121"});
}

TEST(Dataset, AnotherFolderIsNoDataSet)
{
  const TemporaryFolder folder;
  expectWords(failure(folder.path("")), {"no data set", "truth.json", "models_info.json"});
  expectWords(failure(folder.path("none")), {"none", "folder"});
}
}  // namespace
}  // namespace bin_picking
