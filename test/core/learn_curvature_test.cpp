// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/depth_renderer.hpp"
#include "bin_picking_perception/model/part.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"
#include "bin_picking_perception/scene/surface_resampling.hpp"
#include "mesh_shapes.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
constexpr double LEAF = 0.003;

/// A model with so few views for the silhouettes that training is fast.
std::shared_ptr<const TrainedModel> modelOf(const TriangleMesh& mesh, TrainingParameters parameters = {},
                                            int threads = 2)
{
  const test::TemporaryFolder folder;
  PartDefinition part;
  part.name = "shape";
  part.mesh_file = folder.path("shape.stl");
  std::ofstream(part.mesh_file, std::ios::binary) << test::binaryStl(mesh, "shape");
  parameters.leaf = LEAF;
  parameters.matching_leaf = LEAF;
  parameters.num_views = 64;
  return trainPart(part, parameters, Executor(threads));
}

std::string remarksOf(const TrainedModel& model)
{
  std::string text;
  for (const std::string& remark : model.remarks)
    text += remark + "\n";
  return text;
}

TEST(LearnCurvature, ABallHasOneCurvatureAndNeedsNone)
{
  const double radius = 0.03;
  const auto model = modelOf(test::sphereMesh(static_cast<float>(radius), 5));
  for (const float curvature : model->points.curvature)
    // A quadric fitted out to a third of the radius of a sphere bends up to a tenth more than its apex.
    EXPECT_NEAR(curvature, 1 / radius, 0.12 / radius);
  EXPECT_EQ(model->parameters.feature, FeatureKind::Ppf);
  EXPECT_EQ(model->table.quantizer().curvature_bins, 1);
  test::expectWords(remarksOf(*model), {"feature ppf, without curvature"});
}

TEST(LearnCurvature, APlateIsFlatAwayFromItsRim)
{
  const auto model = modelOf(test::box(0.08f, 0.06f, 0.008f));
  int inner = 0;
  for (std::size_t i = 0; i < model->points.size(); ++i)
  {
    const Eigen::Vector3f& p = model->points.points[i];
    const float to_rim = std::min(0.04f - std::abs(p.x()), 0.03f - std::abs(p.y()));
    if (std::abs(model->points.normals[i].z()) < 0.99f || to_rim < 0.0115f)  // the curvature radius is 10 mm
      continue;
    EXPECT_NEAR(model->points.curvature[i], 0, 1.5) << "a fraction of a bin";
    ++inner;
  }
  EXPECT_GT(inner, 300);  // two faces of 57 x 37 mm at 3 mm
}

/// How far the curvature that a scene shows is off the model's at the nearest model point, 1/m, over free parts in
/// several attitudes; neighbourhoods that an edge cuts off are left out, as they meet every bin.
double medianDisagreement(const TrainedModel& model)
{
  const Executor executor(2);
  const TrainingParameters& p = model.parameters;
  const KdTree tree(model.points.points);
  std::vector<float> differences;
  for (int k = 0; k < 8; ++k)
  {
    Pose T_camera_object = Eigen::Translation3d(0, 0, 600 * p.leaf / 3) *
                           Eigen::AngleAxisd(0.4 + 0.8 * k, Eigen::Vector3d(1, 2, 3 - k).normalized());
    T_camera_object.translation() -= T_camera_object.linear() * model.center;
    DepthRenderer renderer(320, 240, {600, 600, 160, 120});  // three pixels a leaf
    renderer.draw(model.mesh, T_camera_object, 0);
    const DepthGrid grid = renderer.grid();
    const ConnectedRuns runs = connectedRuns(grid, EdgeRule(), executor);
    const std::vector<Eigen::Vector3f> normals = estimateGridNormals(grid, runs, p.normal_radius, executor);
    SceneSamples samples = sampleScene(grid, normals, p.matching_leaf, PreprocessingParameters());
    estimateGridCurvature(samples, grid, runs, normals, p.curvature_measure, p.curvature_radius, OPPOSITE_WALL_ANGLE,
                          executor);
    const Pose T_object_camera = T_camera_object.inverse();
    for (std::size_t i = 0; i < samples.size(); ++i)
    {
      const Eigen::Vector3f at = (T_object_camera * samples.points[i].cast<double>()).cast<float>();
      const Eigen::Vector3f normal = (T_object_camera.linear() * samples.normals[i].cast<double>()).cast<float>();
      const auto near = tree.nearest(at, static_cast<float>(p.matching_leaf / 2));
      if (!samples.curvature_complete[i] || std::isnan(samples.curvature[i]) || near.index < 0)
        continue;
      const auto m = static_cast<std::size_t>(near.index);
      if (normal.dot(model.points.normals[m]) > 0.9f)
        differences.push_back(std::abs(samples.curvature[i] - model.points.curvature[m]));
    }
  }
  EXPECT_GT(differences.size(), 50u);
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return static_cast<double>(*middle);
}

TEST(LearnCurvature, ViewsAgreeWithScenesWhereTheAllRoundFitReachesAroundThinWalls)
{
  const PartDefinition bracket = loadPart(std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/l_bracket");
  TrainingParameters parameters;
  parameters.num_views = 64;
  const double in_views = medianDisagreement(*trainPart(bracket, parameters, Executor(2)));
  parameters.curvature_in_views = false;
  const double all_round = medianDisagreement(*trainPart(bracket, parameters, Executor(2)));
  EXPECT_LT(in_views, all_round / 3);
  EXPECT_LT(in_views, 5) << "1/m, a fraction of a bin";
}

TEST(LearnCurvature, APartOfSeveralCurvaturesUsesThem)
{
  const auto model = modelOf(test::tubeMesh(0.02f, 0.012f, 0.05f, 64));
  EXPECT_EQ(model->parameters.feature, FeatureKind::CurPpf);
  EXPECT_GE(model->table.quantizer().curvature_bins, 3);
  test::expectWords(remarksOf(*model), {"feature cur_ppf", "single views repeat it to"});
}

TEST(LearnCurvature, AStatedFeatureIsKept)
{
  TrainingParameters parameters;
  parameters.feature = FeatureKind::Ppf;
  const auto model = modelOf(test::tubeMesh(0.02f, 0.012f, 0.05f, 64), parameters);
  EXPECT_EQ(model->parameters.feature, FeatureKind::Ppf);
  EXPECT_EQ(model->table.quantizer().curvature_bins, 1);
}

TEST(LearnCurvature, IsTheSameForAnyNumberOfThreads)
{
  const TriangleMesh mesh = test::tubeMesh(0.02f, 0.012f, 0.05f, 32);
  EXPECT_EQ(modelOf(mesh, {}, 1)->points.curvature, modelOf(mesh, {}, 2)->points.curvature);
}
}  // namespace
}  // namespace bin_picking
