// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <cmath>

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

void expectSameDepth(const DepthGrid& read, const DepthGrid& written)
{
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i)
  {
    ASSERT_NEAR(read.z[i], written.z[i], 0.6e-3 * BopFolder::STEP);  // half a unit of the picture
    ASSERT_NEAR(read.x[i], written.x[i], 0.6e-3 * BopFolder::STEP);
  }
}

TEST(BopDataset, IsReadInMetres)
{
  const BopFolder folder;
  const EvaluationDataset dataset = openDataset(folder.path(""), {});
  ASSERT_EQ(dataset.scenes.size(), 2u);
  EXPECT_EQ(dataset.scenes[0].name, "000003/000009") << "by number, not as text";
  EXPECT_EQ(dataset.scenes[1].image_id, 10);
  EXPECT_EQ(dataset.scenes[1].scene_id, 3);
  ASSERT_EQ(dataset.parts.size(), 1u);
  EXPECT_EQ(dataset.parts[0].definition.name, "obj_000005");
  EXPECT_EQ(dataset.parts[0].object_id, 5);
  EXPECT_NEAR(dataset.parts[0].diameter, 0.0916515, 1e-9);
  EXPECT_EQ(dataset.parts[0].definition.symmetry.discrete.size(), 2u);
  ASSERT_EQ(dataset.scenes[0].instances.size(), 1u);
  EXPECT_TRUE(dataset.scenes[0].instances[0].T_camera_object.isApprox(barPose(), 1e-9));
  for (const EvaluationScene& scene : dataset.scenes)  // one is a PNG, one a TIFF
    expectSameDepth(loadSceneGrid(scene, {}), barScan(barPose()));
}

TEST(BopDataset, ZeroIsNotMeasured)
{
  const BopFolder folder;
  DepthGrid grid = barScan(barPose());
  grid.invalidate(grid.index(5, 7));
  folder.writeDepth("val/000003/depth/000009.png", grid);
  const DepthGrid read = loadSceneGrid(openDataset(folder.path(""), {}).scenes[0], {});
  EXPECT_TRUE(std::isnan(read.z[static_cast<std::size_t>(read.index(5, 7))]));
  EXPECT_TRUE(read.valid(read.index(6, 7)));
}

TEST(BopDataset, VisibilityIsReadOrMeasured)
{
  const BopFolder folder;
  // A board 100 mm before the bar hides what is right of its middle (at x = 0.01 m).
  DepthRenderer board(160, 120, pictureCamera());
  board.draw(barMesh(), barPose(), 0);
  DepthGrid grid = board.grid();
  for (int v = 0; v < grid.height; ++v)
    for (int u = 85; u < grid.width; ++u)
      grid.z[static_cast<std::size_t>(grid.index(u, v))] = 0.5f;
  folder.writeDepth("val/000003/depth/000009.png", grid);
  EvaluationDataset dataset = openDataset(folder.path(""), {});
  EXPECT_TRUE(std::isnan(dataset.scenes[0].instances[0].visible_fraction));
  const PartShapes shapes = loadPartShapes(dataset, Executor());
  for (EvaluationScene& scene : dataset.scenes)
    estimateVisibility(scene, loadSceneGrid(scene, {}), shapes);
  // u = 300 * 0.01 / 0.6 + 79.5 = 84.5 is the middle of the bar, up to the nearer upper edge's perspective.
  EXPECT_NEAR(dataset.scenes[0].instances[0].visible_fraction, 0.5, 0.03);
  EXPECT_EQ(dataset.scenes[1].instances[0].visible_fraction, 1);
  EXPECT_GT(dataset.scenes[1].instances[0].visible_pixels, 500);
  EXPECT_EQ(dataset.scenes[1].instances[0].visible_pixels, dataset.scenes[1].instances[0].valid_pixels);

  folder.writeFile("val/000003/scene_gt_info.json",
                   "{\"9\": [{\"visib_fract\": 0.25, \"px_count_visib\": 77}], \"10\": [{\"visib_fract\": 1}]}");
  const EvaluationDataset stated = openDataset(folder.path(""), {});
  EXPECT_EQ(stated.scenes[0].instances[0].visible_fraction, 0.25);
  EXPECT_EQ(stated.scenes[0].instances[0].visible_pixels, 77);
}

TEST(BopDataset, SplitsAreNamed)
{
  const BopFolder folder;
  std::filesystem::copy(folder.path("val"), folder.path("train_pbr"), std::filesystem::copy_options::recursive);
  const auto refused = [&](const std::string& split) {
    return messageOf<ParameterError>([&] { openDataset(folder.path(""), {split, {}, 0}); });
  };
  expectWords(refused(""), {"train_pbr, val", "--split"});
  expectWords(refused("test"), {"'test'", "train_pbr, val"});
  EXPECT_EQ(openDataset(folder.path(""), {"val", {}, 0}).scenes.size(), 2u);
  std::filesystem::remove_all(folder.path("val"));
  std::filesystem::remove_all(folder.path("train_pbr"));
  expectWords(failure(folder.path("")), {"no split"});
}

TEST(BopDataset, TargetsRestrictTestSplits)
{
  const BopFolder folder;
  folder.writeFile("test_targets_bop19.json", "[{\"scene_id\": 3, \"im_id\": 10, \"obj_id\": 5, \"inst_count\": 1}]");
  EXPECT_EQ(openDataset(folder.path(""), {}).scenes.size(), 2u) << "val is no test split";
  std::filesystem::rename(folder.path("val"), folder.path("test_primesense"));
  const EvaluationDataset dataset = openDataset(folder.path(""), {});
  ASSERT_EQ(dataset.scenes.size(), 1u);
  EXPECT_EQ(dataset.scenes[0].image_id, 10);
  folder.writeFile("test_targets_bop19.json", "[{\"scene_id\": 3}]");
  expectWords(failure(folder.path("")), {"test_targets_bop19.json", "im_id"});
}

TEST(BopDataset, PartsAreSelectedByName)
{
  const BopFolder folder;
  EXPECT_EQ(openDataset(folder.path(""), {"", {"obj_000005"}, 1}).scenes.size(), 1u);
  expectWords(messageOf<ParameterError>([&] {
                openDataset(folder.path(""), {"", {"obj_000006"}, 0});
              }),
              {"obj_000006", "obj_000005"});
}

TEST(BopDataset, DamageIsToldBeforeAnyWork)
{
  const BopFolder folder;
  folder.writeTruth(Json({{"9", {bopInstance(6, barPose())}}}));
  expectWords(failure(folder.path("")), {"obj_000006", "models_info.json"});
  Pose mirrored = barPose();
  mirrored.linear().row(1) *= -1;
  folder.writeTruth(Json({{"9", {bopInstance(5, mirrored)}}}));
  expectWords(failure(folder.path("")), {"instance 0 of image 9", "scene_gt.json", "mirror image"});
  folder.writeTruth(Json({{"9", {{{"obj_id", 5}}}}}));
  expectWords(failure(folder.path("")), {"scene_gt.json", "cam_R_m2c"});
  folder.writeTruth(Json({{"nine", Json::array()}}));
  expectWords(failure(folder.path("")), {"'nine'"});
  folder.writeTruth(Json({{"11", {bopInstance(5, barPose())}}}));
  expectWords(failure(folder.path("")), {"000011.png", "missing"});
  folder.writeTruth(Json({{"9", {bopInstance(5, barPose())}}}));
  folder.writeFile("val/000003/scene_gt_info.json", "{\"9\": []}");
  expectWords(failure(folder.path("")), {"scene_gt_info.json", "visib_fract"});
  std::filesystem::remove(folder.path("val/000003/scene_gt_info.json"));
  folder.writeFile("val/000003/scene_camera.json", "{\"9\": {\"cam_K\": [300]}}");
  expectWords(failure(folder.path("")), {"scene_camera.json", "cam_K"});
  std::filesystem::remove(folder.path("val/000003/scene_camera.json"));
  expectWords(failure(folder.path("")), {"scene_camera.json", "missing"});
  std::filesystem::remove(folder.path("models/obj_000005.ply"));
  EXPECT_FALSE(failure(folder.path("")).empty());
}

TEST(BopDataset, PicturesThatDoNotFitAreRefused)
{
  const BopFolder folder;
  const EvaluationScene scene = openDataset(folder.path(""), {}).scenes[0];
  const auto refused = [&] { return messageOf<FileError>([&] { loadSceneGrid(scene, {}); }); };
  cv::imwrite(scene.file, cv::Mat(60, 70, CV_16UC1, cv::Scalar(100)));
  expectWords(refused(), {"000009.png", "70 x 60", "79.5"});
  cv::imwrite(scene.file, cv::Mat(120, 160, CV_8UC3, cv::Scalar::all(100)));
  expectWords(refused(), {"000009.png", "16 bits"});
  folder.writeFile("val/000003/depth/000009.png", "no picture");
  expectWords(refused(), {"000009.png", "damaged"});
  folder.writeDepth("val/000003/depth/000009.png", barScan(barPose()));
  std::filesystem::create_directories(folder.path("val/000003/rgb"));
  cv::imwrite(folder.path("val/000003/rgb/000009.png"), cv::Mat(240, 320, CV_8UC3, cv::Scalar::all(1)));
  const EvaluationScene with_color = openDataset(folder.path(""), {}).scenes[0];
  expectWords(messageOf<FileError>([&] { loadSceneGrid(with_color, {}); }), {"160 x 120", "320 x 240", "rgb"});
}
}  // namespace
}  // namespace bin_picking
