// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
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

TEST(LearnCurvature, AllRoundCurvatureSeesThroughAGapAndViewsDoNot)
{
  // Two plates, the lower one beyond a gap of 2 mm and 6 mm deeper: a ball around a point of the upper one holds both.
  TriangleMesh mesh = test::box(0.04f, 0.05f, 0.012f);
  TriangleMesh lower = test::box(0.04f, 0.05f, 0.012f);
  for (Eigen::Vector3f& v : lower.vertices)
    v += Eigen::Vector3f(0.042f, 0, -0.006f);
  const auto offset = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), lower.vertices.begin(), lower.vertices.end());
  for (const auto& t : lower.triangles)
    mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  TrainingParameters paper;
  paper.curvature_in_views = false;
  const auto seen = modelOf(mesh);
  const auto around = modelOf(mesh, paper);
  ASSERT_EQ(seen->points.size(), around->points.size());
  int near = 0;
  double difference = 0;
  for (std::size_t i = 0; i < seen->points.size(); ++i)
  {
    const Eigen::Vector3f& p = seen->points.points[i];
    if (seen->points.normals[i].z() < 0.99f || p.x() < 0.022f || p.x() > 0.027f || std::abs(p.y()) > 0.015f)
      continue;  // the lower plate's edge at the gap, where the upper plate rises beside it
    difference += std::abs(static_cast<double>(seen->points.curvature[i] - around->points.curvature[i]));
    ++near;
  }
  ASSERT_GT(near, 8);
  EXPECT_GT(difference / near, 5) << "1/m";
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
