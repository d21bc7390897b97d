// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// Where faces end: in scans, and in what training learns of a part.
#include "bin_picking_perception/scene/edge_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "analytic_scenes.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"
#include "mesh_shapes.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using test::render;

constexpr double PIXEL = 0.001;  // of the test camera at 0.8 m
constexpr double MIN_DROP = 0.004;

OrientedPoints edgesOf(const DepthGrid& grid)
{
  const Executor executor(2);
  const ConnectedRuns runs = connectedRuns(grid, EdgeRule(), executor);
  const auto normals = estimateGridNormals(grid, runs, 0.004, executor);
  return edgePoints(grid, normals, findDepthEdges(grid, grid, runs, MIN_DROP, executor));
}

/// A rectangle of 60 x 40 mm in front of a floor, turned by `tilt` about the x axis through its middle.
DepthGrid plate(double tilt)
{
  const Eigen::Vector3d middle(0, 0, 0.76);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const auto inside = [=](const Eigen::Vector3d& p) {
    const Eigen::Vector3d q = R.transpose() * (p - middle);
    return std::abs(q.x()) <= 0.03 && std::abs(q.y()) <= 0.02;
  };
  return render({test::plane(middle, R * -Eigen::Vector3d::UnitZ(), inside),
                 test::plane({0, 0, 0.8}, -Eigen::Vector3d::UnitZ())});
}

TEST(EdgePoints, lieOnTheRimOfAPlateAndPointOutOfIt)
{
  for (const double tilt : {0.0, 0.3})
  {
    const Eigen::Matrix3f R =
        Eigen::AngleAxisf(static_cast<float>(tilt), Eigen::Vector3f::UnitX()).toRotationMatrix().transpose();
    const OrientedPoints edges = edgesOf(plate(tilt));
    ASSERT_GT(edges.size(), 150u) << "the rim is 200 pixels long";
    std::array<int, 4> per_side = {};
    int askew = 0;
    for (std::size_t i = 0; i < edges.size(); ++i)
    {
      const Eigen::Vector3f p = R * (edges.points[i] - Eigen::Vector3f(0, 0, 0.76f));
      const Eigen::Vector3f outward = R * edges.normals[i];
      const float off = std::max(std::abs(p.x()) - 0.03f, std::abs(p.y()) - 0.02f);
      EXPECT_LT(std::abs(off), PIXEL) << p.transpose();
      EXPECT_LT(std::abs(p.z()), 0.3 * PIXEL) << "in the plate's plane";
      EXPECT_LT(std::abs(outward.z()), 0.05f) << "in the plate's plane";
      EXPECT_NEAR(outward.norm(), 1, 1e-5);
      const bool is_end = std::abs(p.x()) - 0.03f > std::abs(p.y()) - 0.02f;
      const Eigen::Vector3f side = is_end ? Eigen::Vector3f(std::copysign(1.0f, p.x()), 0, 0)
                                          : Eigen::Vector3f(0, std::copysign(1.0f, p.y()), 0);
      ++per_side[is_end ? (p.x() > 0 ? 0 : 1) : (p.y() > 0 ? 2 : 3)];
      askew += outward.dot(side) < 0.9f;
    }
    for (const int count : per_side)
      EXPECT_GT(count, 25) << "tilt " << tilt;
    EXPECT_LE(askew, 12) << "only at the four corners";
  }
}

TEST(EdgePoints, areNoneWhereASurfaceTurnsAway)
{
  const auto floor = test::plane({0, 0, 0.8}, -Eigen::Vector3d::UnitZ());
  const OrientedPoints of_ball = edgesOf(render({test::sphere({0, 0, 0.75}, 0.03), floor}));
  EXPECT_EQ(of_ball.size(), 0u) << "the silhouette of a ball moves with the camera";
  // The long sides of a lying pipe are silhouettes too; its ends are not.
  const OrientedPoints of_pipe =
      edgesOf(render({test::cylinder({0, 0, 0.75}, Eigen::Vector3d::UnitX(), 0.02, 0.08), floor}));
  ASSERT_GT(of_pipe.size(), 20u);
  for (std::size_t i = 0; i < of_pipe.size(); ++i)
    EXPECT_NEAR(std::abs(of_pipe.points[i].x()), 0.04, 1.5 * PIXEL);
}

TEST(EdgePoints, areNoneOfWhatIsOnlyHidden)
{
  // The floor ends at the plate in the picture, but not in the world: every edge belongs to the plate.
  for (const Eigen::Vector3f& p : edgesOf(plate(0)).points)
    EXPECT_NEAR(p.z(), 0.76, 1e-4);
}

TEST(EdgePoints, areNotSeenAcrossASlant)
{
  // Turned by 40 degrees about x, the sides along x hide how far they reach; those along y show it.
  const double tilt = 0.7;
  const Eigen::Matrix3f R =
      Eigen::AngleAxisf(static_cast<float>(tilt), Eigen::Vector3f::UnitX()).toRotationMatrix().transpose();
  const OrientedPoints edges = edgesOf(plate(tilt));
  ASSERT_GT(edges.size(), 40u);
  int of_long_sides = 0;
  for (const Eigen::Vector3f& p : edges.points)
  {
    const Eigen::Vector3f q = R * (p - Eigen::Vector3f(0, 0, 0.76f));
    of_long_sides += std::abs(q.x()) < 0.027f;
  }
  EXPECT_EQ(of_long_sides, 0);
}

std::shared_ptr<const TrainedModel> trainedOn(const TriangleMesh& mesh, bool edge_pairs = true)
{
  const test::TemporaryFolder folder;
  PartDefinition part;
  part.name = "shape";
  part.mesh_file = folder.path("shape.stl");
  std::ofstream(part.mesh_file, std::ios::binary) << test::binaryStl(mesh, "shape");
  TrainingParameters parameters;
  parameters.leaf = 0.003;
  parameters.matching_leaf = 0.005;
  parameters.num_views = 64;
  parameters.edge_pairs = edge_pairs;
  return trainPart(part, parameters, Executor(2));
}

TEST(EdgeModel, aBoxHasTheEdgesOfItsFaces)
{
  const Eigen::Vector3f half(0.03f, 0.022f, 0.016f);
  const auto model = trainedOn(test::box(2 * half.x(), 2 * half.y(), 2 * half.z()));
  ASSERT_FALSE(model->edges.empty());
  ASSERT_EQ(model->edges.normals.size(), model->edges.size());
  // Per face and side of it: an edge between faces a and b is one of a that points along b's normal, and one of b.
  constexpr float PLACE = 0.0017f;  // views have pixels of 1 mm, and an edge lies in one or the next
  std::array<std::array<int, 6>, 6> found = {};
  int at_corners = 0;
  int beside = 0;
  for (std::size_t i = 0; i < model->edges.size(); ++i)
  {
    const Eigen::Vector3f inside = half - model->edges.points[i].cwiseAbs();
    if (inside.maxCoeff() < 0.005f)  // means of two sides
    {
      ++at_corners;
      continue;
    }
    EXPECT_LT(inside.cwiseAbs().minCoeff(), PLACE) << "not on a face: " << model->edges.points[i].transpose();
    if ((inside.array().abs() < PLACE).count() < 2)
    {
      ++beside;
      continue;
    }
    int along = 0;
    EXPECT_GT(model->edges.normals[i].cwiseAbs().maxCoeff(&along), 0.85f);
    EXPECT_LT(std::abs(inside[along]), PLACE) << "the direction leaves the box there";
    const int side = 2 * along + (model->edges.normals[i][along] > 0);
    for (int axis = 0; axis < 3; ++axis)
      if (axis != along && std::abs(inside[axis]) < PLACE)
        ++found[static_cast<std::size_t>(2 * axis + (model->edges.points[i][axis] > 0))]
               [static_cast<std::size_t>(side)];
  }
  EXPECT_LT(beside, 0.05 * static_cast<double>(model->edges.size()));
  EXPECT_LT(at_corners, static_cast<int>(model->edges.size()) / 3);
  for (std::size_t face = 0; face < 6; ++face)
    for (std::size_t side = 0; side < 6; ++side)
      EXPECT_TRUE(found[face][side] > 0 || face / 2 == side / 2) << "face " << face << ", side " << side;
  EXPECT_GT(model->edge_table.numEntries(), 1000u);
  EXPECT_EQ(model->edge_table.references(), model->table.references());
}

TEST(EdgeModel, aBallHasNoneAndNobodyHasWithoutEdgePairs)
{
  const auto ball = trainedOn(test::sphereMesh(0.03f, 5));
  EXPECT_TRUE(ball->edges.empty());
  EXPECT_EQ(ball->edge_table.numEntries(), 0u);
  const auto box = trainedOn(test::box(0.06f, 0.04f, 0.02f), false);
  EXPECT_TRUE(box->edges.empty());
  EXPECT_EQ(box->edge_table.numEntries(), 0u);
}
}  // namespace
}  // namespace bin_picking
