// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/refinement/icp.hpp"

#include <gtest/gtest.h>

#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"
#include "mesh_shapes.hpp"
#include "tee_scene.hpp"

namespace bin_picking
{
namespace
{
constexpr double DEGREE = M_PI / 180;
constexpr std::size_t ALL_PIXELS = 1000000;

/// What the detector knows of a scene when it refines: parts above a floor at 0.66 m.
struct Scene
{
  Scene(const DepthGrid& measured, const TrainedModel& model) : surroundings(measured), grid(measured)
  {
    for (std::size_t i = 0; i < grid.size(); ++i)
      if (grid.z[i] > 0.655f)
        grid.invalidate(static_cast<int>(i));
    const Executor executor(1);
    const ConnectedRuns runs = connectedRuns(grid, EdgeRule(), executor);
    normals = estimateGridNormals(grid, runs, model.parameters.normal_radius, executor);
    edges = findDepthEdges(grid, surroundings, runs, model.parameters.leaf / 2, executor);
  }

  IcpResult refine(const TrainedModel& model, const Pose& start) const
  {
    return icpDistanceField(model, measuredNear(model, start, grid, normals, edges, ALL_PIXELS), start, {});
  }

  DepthGrid surroundings;
  DepthGrid grid;
  std::vector<Eigen::Vector3f> normals;
  DepthEdges edges;
};

TrainedModel modelOf(const OrientedPoints& surface, const Eigen::Vector3d& size, double leaf)
{
  TrainedModel model;
  model.surface = surface;
  model.size = size;
  model.parameters.leaf = leaf;
  model.parameters.normal_radius = 1.3 * leaf;
  model.field = DistanceField(surface, leaf / 3, 1.5 * leaf);
  return model;
}

/// A block of 60 x 40 x 24 mm lies on the floor; from straight above only its top is seen.
struct BlockScene
{
  BlockScene()
  {
    const TriangleMesh mesh = test::box(0.060f, 0.040f, 0.024f);
    model = modelOf(sampleSurface(mesh, 0.0005, 1), {0.060, 0.040, 0.024}, 0.003);
    truth.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix() *
                     Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    truth.translation() = Eigen::Vector3d(0, 0, 0.648) - truth.linear() * model.center;
    DepthRenderer renderer(480, 384, test::smallCamera());
    renderer.draw(test::floorMesh(), Pose::Identity(), 0);
    renderer.draw(mesh, truth, 1);
    measured = withoutRim(renderer.grid());
  }

  /// Sensors lose the last pixel before an edge.
  static DepthGrid withoutRim(const DepthGrid& whole)
  {
    const auto isTop = [&](int u, int v) { return whole.z[static_cast<std::size_t>(whole.index(u, v))] < 0.65f; };
    DepthGrid grid = whole;
    for (int v = 1; v + 1 < whole.height; ++v)
      for (int u = 1; u + 1 < whole.width; ++u)
        if (isTop(u, v) && !(isTop(u - 1, v) && isTop(u + 1, v) && isTop(u, v - 1) && isTop(u, v + 1)))
          grid.invalidate(grid.index(u, v));
    return grid;
  }

  TrainedModel model;
  Pose truth = Pose::Identity();
  DepthGrid measured;
};

double centerError(const Pose& T, const Pose& truth, const TrainedModel& model)
{
  return (T * model.center - truth * model.center).norm();
}

TEST(IcpDistanceField, RemovesASmallErrorAndStaysRigid)
{
  const TrainedModel& tee = *test::teeModel();
  const auto poses = test::posesApart(4, 9);
  const Scene scene(test::renderTees(poses, 0.0001), tee);
  std::mt19937 random(2);
  for (const auto& truth : poses)
  {
    Pose start = truth;
    start.linear() = truth.linear() * Eigen::AngleAxisd(0.06, test::unitVector(random)).toRotationMatrix();
    start.translation() += 0.002 * test::unitVector(random);
    const IcpResult result = scene.refine(tee, start);
    // sigma 0.1 mm on some 2000 pixels: the statistical error is below 0.01 mm; the field's cells round edges off.
    EXPECT_LT(centerError(result.T_camera_object, truth, tee), 0.0001);
    EXPECT_LT(test::rotationError(result.T_camera_object, truth), 0.003);
    EXPECT_NEAR(result.T_camera_object.linear().determinant(), 1, 1e-12);
    EXPECT_GT(result.correspondences, 500);
    EXPECT_LT(result.rms, 0.0003);
  }
}

TEST(IcpDistanceField, OutlineHoldsAFaceInItsOwnPlane)
{
  const BlockScene block;
  const Scene scene(block.measured, block.model);
  for (const double turn : {-3.0, 0.0, 3.0})
    for (const Eigen::Vector3d& shift : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.0015, -0.001, 0)})
    {
      Pose start = block.truth;
      start.linear() =
          Eigen::AngleAxisd(turn * DEGREE, Eigen::Vector3d::UnitZ()).toRotationMatrix() * block.truth.linear();
      start.translation() = block.truth * block.model.center + shift - start.linear() * block.model.center;
      const IcpResult result = scene.refine(block.model, start);
      // A pixel is 0.8 mm; along a side of 40 mm fifty of them tell where it is.
      EXPECT_LT(centerError(result.T_camera_object, block.truth, block.model), 0.0003) << turn << ' ' << shift.x();
      EXPECT_LT(test::rotationError(result.T_camera_object, block.truth), 0.4 * DEGREE) << turn << ' ' << shift.x();
    }
}

TEST(IcpDistanceField, WithoutEdgesAFaceKeepsItsTurn)
{
  const BlockScene block;
  Scene scene(block.measured, block.model);
  for (auto& row : scene.edges.rows)
    row.clear();
  Pose start = block.truth;
  start.linear() = Eigen::AngleAxisd(3 * DEGREE, Eigen::Vector3d::UnitZ()).toRotationMatrix() * block.truth.linear();
  start.translation() = block.truth * block.model.center - start.linear() * block.model.center;
  EXPECT_GT(test::rotationError(scene.refine(block.model, start).T_camera_object, block.truth), 2 * DEGREE)
      << "nothing but the outline tells the turn: the test above would not test it";
}

TEST(IcpDistanceField, DoesNotSlideAlongACylinder)
{
  // Only the side of a long cylinder is in the picture: nothing holds it along its axis.
  DepthRenderer renderer(480, 384, test::smallCamera());
  const OrientedPoints tube = test::cylinder(0.02, 1.0, 400000);
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  T.translation().z() = 0.6;
  renderer.draw(tube, T, 0.001, 1);
  const TrainedModel model = modelOf(test::cylinder(0.02, 0.1, 40000), {0.04, 0.04, 0.1}, 0.004);
  const Scene scene(renderer.grid(), model);
  Pose start = T;
  start.translation() += Eigen::Vector3d(0.003, 0.0015, 0.001);
  const Eigen::Vector3d moved = scene.refine(model, start).T_camera_object.translation() - T.translation();
  EXPECT_NEAR(moved.x(), 0.003, 0.0005) << "slid along the axis";
  EXPECT_NEAR(moved.y(), 0, 0.0002);
  EXPECT_NEAR(moved.z(), 0, 0.0005);
}

TEST(IcpDistanceField, WithoutDataThePoseStaysAndRmsIsNan)
{
  const TrainedModel& tee = *test::teeModel();
  const Scene scene(makeGrid(480, 384, test::smallCamera()), tee);
  const auto start = test::posesApart(1, 1)[0];
  const IcpResult result = scene.refine(tee, start);
  EXPECT_TRUE(std::isnan(result.rms));
  EXPECT_FALSE(result.converged);
  EXPECT_TRUE(result.T_camera_object.matrix() == start.matrix());
}

TEST(MeasuredNear, BehindTheCameraNothingIsMeasured)
{
  const BlockScene block;
  const Scene scene(block.measured, block.model);
  Pose behind = block.truth;
  behind.translation().z() = -0.6;
  const MeasuredPart measured = measuredNear(block.model, behind, scene.grid, scene.normals, scene.edges, ALL_PIXELS);
  EXPECT_TRUE(measured.surface.empty());
  EXPECT_TRUE(measured.edges.empty());
}

TEST(DepthEdges, LieOnTheOutlineAndPointAwayFromTheSurface)
{
  const BlockScene block;
  const Scene scene(block.measured, block.model);
  const Pose T_object_camera = block.truth.inverse();
  int count = 0;
  for (int v = 0; v < scene.grid.height; ++v)
    for (const DepthEdge& edge : scene.edges.rows[static_cast<std::size_t>(v)])
    {
      const Eigen::Vector3d p = scene.grid.point(scene.grid.index(edge.column, v)).cast<double>();
      const Eigen::Vector3d in_part = T_object_camera * p - block.model.center;
      const Eigen::Vector2d to_side = Eigen::Vector2d(0.030, 0.020) - in_part.head<2>().cwiseAbs();
      EXPECT_GE(to_side.minCoeff(), -1e-4);
      EXPECT_LT(to_side.minCoeff(), 3 * 0.0008) << "three pixels, one of which is lost";
      const Eigen::Vector3d outward = T_object_camera.linear() * Eigen::Vector3d(edge.outward.x(), edge.outward.y(), 0);
      EXPECT_GT(outward.head<2>().dot(in_part.head<2>().cwiseQuotient(Eigen::Vector2d(0.030, 0.020))), 0);
      ++count;
    }
  // A circumference of 200 mm in pixels of 0.8 mm.
  EXPECT_GT(count, 200);
  EXPECT_LT(count, 450);
}

TEST(DepthEdges, BesideAShadowIsNone)
{
  BlockScene block;
  for (int v = 0; v < block.measured.height; ++v)
    for (int u = 0; u < block.measured.width; ++u)
      if (block.measured.z[static_cast<std::size_t>(block.measured.index(u, v))] > 0.65f)
        block.measured.invalidate(block.measured.index(u, v));
  const Scene scene(block.measured, block.model);
  for (const auto& row : scene.edges.rows)
    EXPECT_TRUE(row.empty());
}
}  // namespace
}  // namespace bin_picking
