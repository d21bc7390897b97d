// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
//
// What stands between the programs of benchmark_peers and its figures: the process around them, what is prepared for
// them, the depth check.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/depth_renderer.hpp"
#include "child_process.hpp"
#include "depth_check.hpp"
#include "figures.hpp"
#include "mesh_shapes.hpp"
#include "text_table.hpp"

namespace bin_picking::peers
{
namespace
{
Pose inFront(double distance)
{
  Pose T_camera_object = Pose::Identity();
  T_camera_object.translation().z() = distance;
  return T_camera_object;
}

/// A box of 80 x 60 x 40 mm about the origin.
PeerModel boxModel()
{
  PeerModel model;
  model.mesh = test::box(0.08f, 0.06f, 0.04f);
  Eigen::AlignedBox3f bounds;
  for (const Eigen::Vector3f& vertex : model.mesh.vertices)
    bounds.extend(vertex);
  model.size = bounds.sizes().cast<double>();
  model.center = bounds.center().cast<double>();
  model.diameter = model.size.norm();
  model.surface = sampleSurface(model.mesh, 0.002, 1);
  return model;
}

PeerScene sceneWith(const PeerModel& model, const std::vector<Pose>& poses)
{
  DepthRenderer renderer(640, 480, {600, 600, 320, 240});
  for (const Pose& pose : poses)
    renderer.draw(model.mesh, pose, 0);
  PeerScene scene;
  scene.grid = renderer.grid();
  return scene;
}

TEST(ChildProcess, LinesArriveInOrder)
{
  std::vector<std::string> lines;
  const std::string failure = runInChild(
      [](const LineSink& emit) {
        for (const char* line : {"one", "two", "three"})
          emit(line);
      },
      60, [&](const std::string& line) { lines.push_back(line); });
  EXPECT_EQ(failure, "");
  EXPECT_EQ(lines, (std::vector<std::string>{"one", "two", "three"}));
}

TEST(ChildProcess, WhatWasSaidBeforeACrashIsKept)
{
  std::vector<std::string> lines;
  const std::string failure = runInChild(
      [](const LineSink& emit) {
        emit("before");
        std::abort();
      },
      60, [&](const std::string& line) { lines.push_back(line); });
  EXPECT_EQ(lines, std::vector<std::string>{"before"});
  EXPECT_EQ(failure.rfind("crashed (", 0), 0u) << failure;
}

TEST(ChildProcess, ExceptionsAreReasons)
{
  const auto throws = [](const LineSink&) { throw Error("the table is full"); };
  EXPECT_EQ(runInChild(throws, 60, [](const std::string&) {}), "the table is full");
}

TEST(ChildProcess, EndlessWorkIsEnded)
{
  const auto endless = [](const LineSink& emit) {
    for (double x = 0; x >= 0; x = std::sqrt(x + 1))
      if (x > 2)
        emit("never: the sequence stays below 1.7");
  };
  EXPECT_EQ(runInChild(endless, 1, [](const std::string&) {}), "no result within 1 s");
}

TEST(PeerData, BothFacesOfAThinWallSurviveTheSampling)
{
  OrientedPoints wall;
  for (int i = 0; i < 10; ++i)
    for (const float side : {-1.0f, 1.0f})
    {
      wall.points.emplace_back(0.001f + 0.0001f * static_cast<float>(i), 0.001f, 0.002f + 0.0005f * side);
      wall.normals.emplace_back(0, 0, side);
    }
  const OrientedPoints sampled = sampledInCubes(wall, 0.01);
  ASSERT_EQ(sampled.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i)
  {
    EXPECT_NEAR(std::abs(sampled.normals[i].z()), 1, 1e-6);
    EXPECT_NEAR(sampled.points[i].z() - 0.002f, 0.0005f * sampled.normals[i].z(), 1e-7);
  }
  EXPECT_LT(sampled.normals[0].z() * sampled.normals[1].z(), 0);
}

TEST(PeerData, ShrunkRotationsBecomeRigidAndMirrorsAreRefused)
{
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  Eigen::Matrix4d shrunk = Eigen::Matrix4d::Identity();
  shrunk.topLeftCorner<3, 3>() = 0.9 * turn;
  shrunk(0, 3) = 0.25;
  const std::optional<Pose> rigid = nearestRigid(shrunk);
  ASSERT_TRUE(rigid);
  EXPECT_LT((rigid->linear() - turn).norm(), 1e-12);
  EXPECT_EQ(rigid->translation().x(), 0.25);
  shrunk.row(0) *= -1;
  EXPECT_FALSE(nearestRigid(shrunk));
  shrunk(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(nearestRigid(shrunk));
}

TEST(PeerData, OnlyTheFrontOfABoxIsSeen)
{
  const PeerModel model = boxModel();
  const OrientedPoints seen = seenPoints(model, model.surface, inFront(0.6));
  // Looked at along its z: the face of 80 x 60 mm at one sample per 2 x 2 mm, and no other.
  EXPECT_NEAR(static_cast<double>(seen.size()), 1200, 100);
  for (const Eigen::Vector3f& normal : seen.normals)
    EXPECT_LT(normal.z(), -0.99f);
}

TEST(DepthCheck, KeepsTruePosesOnceAndNothingThatHangsInTheAir)
{
  const PeerModel model = boxModel();
  Pose beside = inFront(0.6);
  beside.translation().x() = 0.12;
  const PeerScene scene = sceneWith(model, {inFront(0.6), beside});
  const Pose nearly = inFront(0.6005);  // half a millimetre off: the same box again
  const auto kept = checkedByDepth({{inFront(0.55), 9}, {inFront(0.6), 5}, {nearly, 4}, {beside, 1}}, model, scene);
  ASSERT_EQ(kept.size(), 2u);
  std::vector<double> places = {kept[0].T_camera_object.translation().x(), kept[1].T_camera_object.translation().x()};
  std::sort(places.begin(), places.end());
  EXPECT_NEAR(places[0], 0, 1e-9);
  EXPECT_NEAR(places[1], 0.12, 1e-9);
}

TEST(TextTable, ColumnsAreAlignedAndRowsComplete)
{
  TextTable table({"program", "ms"});
  table.add({"ours", "9.1"});
  table.add({"a longer name", "1234"});
  EXPECT_EQ(table.text(),
            "| program       |   ms |\n"
            "|---------------|-----:|\n"
            "| ours          |  9.1 |\n"
            "| a longer name | 1234 |\n");
  EXPECT_THROW(table.add({"one cell"}), Error);
}

TEST(Figures, PowersAreRecovered)
{
  const std::vector<double> sizes = {100, 200, 400, 800};
  std::vector<double> times;
  for (const double size : sizes)
    times.push_back(3e-6 * size * size);
  EXPECT_NEAR(growthExponent(sizes, times), 2, 1e-9);
  EXPECT_TRUE(std::isnan(growthExponent({100}, {1})));
}

TEST(Figures, AScanWithoutAnswerIsWrongAndHasNoTime)
{
  PlannedTrial planned;
  planned.trial.part.name = "box";
  EvaluationScene scene;
  scene.instances.push_back({"box", inFront(0.6), 1});
  for (const char* name : {"answered", "crashed"})
  {
    scene.name = name;
    planned.trial.scenes.push_back(scene);
  }
  SceneOutcome outcome;
  outcome.result.poses = {{inFront(0.601), 1}};
  outcome.result.match_seconds = 0.3;
  outcome.result.icp_seconds = 0.1;
  planned.outcome.scenes = {outcome};
  const PartShapes shapes = {{"box", makePartShape(boxModel().mesh, {})}};
  const LoneFigures figures = loneFigures({&planned}, {&planned}, shapes);
  EXPECT_EQ(figures.found.hits, 1);
  EXPECT_EQ(figures.found.total, 2);
  EXPECT_FALSE(figures.shows_matches);
  EXPECT_EQ(figures.total.count, 1);
  EXPECT_DOUBLE_EQ(figures.total.median, 0.4);
  EXPECT_DOUBLE_EQ(figures.ratio.median, 1);
  EXPECT_NEAR(figures.translation.median, 0.001, 1e-9);
}
}  // namespace
}  // namespace bin_picking::peers
