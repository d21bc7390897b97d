// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/bop_results.hpp"

#include <gtest/gtest.h>

#include "bin_picking_perception/common/error.hpp"
#include "core/temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using namespace test;

const std::string HEADER = "scene_id,im_id,obj_id,score,R,t,time\n";

std::vector<BopResult> someResults()
{
  BopResult first;
  first.scene_id = 3;
  first.image_id = 14;
  first.object_id = 15;
  first.score = 1.0 / 3;
  first.T_camera_object =
      Eigen::Translation3d(0.1, -0.2, 0.7) * Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized());
  first.seconds = 0.25;
  BopResult second = first;
  second.score = 0.5;
  second.seconds = -1;
  return {first, second};
}

std::string failure(const std::string& text)
{
  const TemporaryFolder folder;
  const std::string path = folder.write("results.csv", text);
  return messageOf<FileError>([&] { loadBopResults(path); });
}

TEST(BopResults, AreReadBackAsTheyWereWritten)
{
  const TemporaryFolder folder;
  const auto written = someResults();
  const auto read = loadBopResults(folder.write("results.csv", bopResultsCsv(written)));
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t k = 0; k < read.size(); ++k)
  {
    EXPECT_EQ(read[k].scene_id, written[k].scene_id);
    EXPECT_EQ(read[k].image_id, written[k].image_id);
    EXPECT_EQ(read[k].object_id, written[k].object_id);
    EXPECT_EQ(read[k].score, written[k].score);
    EXPECT_EQ(read[k].seconds, written[k].seconds);
    EXPECT_TRUE(read[k].T_camera_object.isApprox(written[k].T_camera_object, 1e-15));
  }
}

TEST(BopResults, AreInMillimetresRowByRow)
{
  const TemporaryFolder folder;
  // A quarter turn about z takes x to y: first row 0 -1 0. Blanks and Windows line ends do not matter.
  const auto read = loadBopResults(folder.write(
      "results.csv", "scene_id,im_id,obj_id,score,R,t,time\r\n1, 2,3,0.5,0 -1 0 1 0 0 0 0 1,10 20 700,-1\r\n\r\n"));
  ASSERT_EQ(read.size(), 1u);
  EXPECT_TRUE((read[0].T_camera_object * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(0.01, 1.02, 0.7), 1e-12));
}

TEST(BopResults, BrokenLinesAreNamed)
{
  expectWords(failure(""), {"results.csv", "missing, empty"});
  expectWords(failure("scene,image\n"), {"scene,image", "scene_id,im_id,obj_id,score,R,t,time"});
  const std::string good = "1,2,3,0.5,1 0 0 0 1 0 0 0 1,10 20 700,-1\n";
  expectWords(failure(HEADER + good + "1,2,3,0.5\n"), {"line 3", "4 cells"});
  expectWords(failure(HEADER + "1,2,3,high,1 0 0 0 1 0 0 0 1,10 20 700,-1\n"), {"line 2", "'high'", "1 number"});
  expectWords(failure(HEADER + "1,2,3,1,1 0 0 0 1 0 0 0,10 20 700,-1\n"), {"9 numbers"});
  expectWords(failure(HEADER + "1.5,2,3,1,1 0 0 0 1 0 0 0 1,10 20 700,-1\n"), {"'1.5'", "whole number"});
  expectWords(failure(HEADER + "1,2,3,1,1 0 0 0 1 0 0 0 -1,10 20 700,-1\n"), {"line 2", "mirror image"});
  expectWords(failure(HEADER + "1,2,3,1,2 0 0 0 2 0 0 0 2,10 20 700,-1\n"), {"no rotation"});
}

TEST(BopResults, GoToTheirScenes)
{
  EvaluationDataset dataset;
  EvaluationPart part;
  part.definition.name = "bar";
  part.object_id = 15;
  dataset.parts.push_back(part);
  dataset.scenes.resize(2);
  dataset.scenes[1].scene_id = 3;
  dataset.scenes[1].image_id = 14;
  for (EvaluationScene& scene : dataset.scenes)
    scene.parts = {"bar"};
  auto results = someResults();
  results.push_back(results[0]);
  results.back().object_id = 16;
  const ResultsOfScenes assigned = assignToScenes(results, dataset, "results.csv");
  EXPECT_TRUE(assigned.estimates[0].empty());
  ASSERT_EQ(assigned.estimates[1].size(), 2u);
  EXPECT_EQ(assigned.estimates[1][1].part, "bar");
  EXPECT_EQ(assigned.seconds[0], -1);
  EXPECT_EQ(assigned.seconds[1], 0.25);
  EXPECT_EQ(assigned.left_out, 1u);
  EXPECT_EQ(assignToScenes({}, dataset, "results.csv").left_out, 0u);
  expectWords(messageOf<FileError>([&] { assignToScenes({results.back()}, dataset, "results.csv"); }),
              {"results.csv", "3/14/16", "0/0/15"});
}
}  // namespace
}  // namespace bin_picking
