// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/refinement/verification.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"
#include "mesh_shapes.hpp"
#include "tee_scene.hpp"

namespace bin_picking
{
namespace
{
struct Scene
{
  DepthGrid surroundings;
  DepthGrid grid;
  std::vector<Eigen::Vector3f> normals;
};

Scene sceneOf(const std::vector<Pose>& poses, double sigma)
{
  Scene scene;
  scene.surroundings = test::renderTees(poses, sigma);
  scene.grid = scene.surroundings;
  for (std::size_t i = 0; i < scene.grid.size(); ++i)
    if (scene.grid.z[i] > 0.655f)
      scene.grid.invalidate(static_cast<int>(i));
  scene.normals = estimateGridNormals(scene.grid, test::teeModel()->parameters.normal_radius, Executor(1));
  return scene;
}

PoseEvidence evidenceOf(const Scene& scene, const Pose& T)
{
  return gatherEvidence(testPoints(*test::teeModel(), facingPoints(*test::teeModel(), T, 2000)), T, scene.grid,
                        scene.surroundings, scene.normals, 0.0015, {});
}

OutlineEvidence outlineOf(const Scene& scene, const Pose& T)
{
  const double leaf = test::teeModel()->parameters.leaf;
  return gatherOutlineEvidence(*test::teeModel(), facingPoints(*test::teeModel(), T, 100000), T, scene.surroundings,
                               leaf, leaf);
}

TrainedModel plateModel()
{
  TrainedModel plate;
  plate.surface = test::plane(0.06, 4000);
  return plate;
}

SurfaceIndices allPoints(const OrientedPoints& points)
{
  SurfaceIndices indices(points.size());
  std::iota(indices.begin(), indices.end(), 0u);
  return indices;
}

TEST(Evidence, truePoseIsExplained)
{
  const auto poses = test::posesApart(1, 4);
  const Scene scene = sceneOf(poses, 0.0001);
  const PoseEvidence evidence = evidenceOf(scene, poses[0]);
  EXPECT_GT(evidence.inlierShare(0.3), 0.93);  // what is lost lies at edges, where pixels and normals mix
  EXPECT_GT(evidence.visibleFraction(), 0.9);
  EXPECT_LT(evidence.violationShare(), 0.03);
  EXPECT_GT(evidence.matchingRate(), 0.98);
  EXPECT_LT(evidence.rms, 0.0004);
  EXPECT_GT(outlineOf(scene, poses[0]).share(), 0.9);
}

TEST(MatchingRate, isTheSameOfTheSurfaceAsOfItsPoints)
{
  constexpr double DISTANCE = 0.002;
  const TrainedModel& model = *test::teeModel();
  ASSERT_LT(DISTANCE, static_cast<double>(model.field.band()));
  const KdTree points(model.surface.points);
  const std::vector<Pose> truth = test::posesApart(1, 4);
  const OrientedPoints seen = transformed(sampleSurface(model.mesh, 0.002, 5), truth[0]);
  EXPECT_EQ(matchingRate(model.field, truth[0], seen.points, DISTANCE), 1);
  EXPECT_EQ(matchingRate(model.field, truth[0], {}, DISTANCE), 0);
  for (const double offset : {0.001, 0.003, 0.01})
  {
    Pose beside = truth[0];
    beside.translation().x() += offset;
    // The tree's points lie beside the place on the surface that is nearest: at the limit some are too far.
    EXPECT_NEAR(matchingRate(model.field, beside, seen.points, DISTANCE),
                matchingRate(points, beside, seen.points, DISTANCE), 0.06)
        << offset;
  }
}

TEST(Evidence, poseInFreeSpaceIsViolated)
{
  const auto poses = test::posesApart(1, 4);
  const Scene scene = sceneOf(poses, 0.0001);
  Pose beside = poses[0];
  beside.translation().x() += 0.15;  // over the bare floor
  const PoseEvidence evidence = evidenceOf(scene, beside);
  EXPECT_GT(evidence.violationShare(), 0.95);
  EXPECT_EQ(evidence.matchingRate(), 0);
  Pose nearer = poses[0];
  nearer.translation().z() -= 0.05;  // floats above the part
  EXPECT_GT(evidenceOf(scene, nearer).violationShare(), 0.9);
}

TEST(Evidence, countsAFaceByItsShareOfThePicture)
{
  // Two plates of equal size and number of points, one seen frontally, the other at 80 degrees: cos 80 deg = 0.17.
  TrainedModel plate = plateModel();
  plate.near_crease.assign(plate.surface.size(), 0);
  const DepthGrid nothing = makeGrid(480, 384, test::smallCamera());
  const std::vector<Eigen::Vector3f> normals(nothing.size(), Eigen::Vector3f::Constant(NAN));
  const auto facing = [&](double tilt) {
    Pose T = Pose::Identity();
    T.linear() = Eigen::AngleAxisd(M_PI + tilt, Eigen::Vector3d::UnitX()).toRotationMatrix();
    T.translation().z() = 3;  // far: nearly parallel rays
    return gatherEvidence(testPoints(plate, allPoints(plate.surface)), T, nothing, nothing, normals, 0.001, {}).facing;
  };
  EXPECT_NEAR(facing(80 * M_PI / 180) / facing(0), std::cos(80 * M_PI / 180), 0.02);
}

TEST(Evidence, hiddenPoseIsNeitherRightNorWrong)
{
  const auto poses = test::posesApart(1, 4);
  const Scene scene = sceneOf(poses, 0.0001);
  Pose behind = poses[0];
  behind.translation().z() += 0.3;  // under the floor
  const PoseEvidence evidence = evidenceOf(scene, behind);
  EXPECT_GT(evidence.occluded, 0.95 * evidence.facing);
  EXPECT_EQ(evidence.violated, 0);
  EXPECT_EQ(evidence.visibleFraction(), 0);
}

TEST(Evidence, unmeasuredIsCountedApart)
{
  const auto poses = test::posesApart(1, 4);
  Scene scene = sceneOf(poses, 0.0001);
  for (std::size_t i = 0; i < scene.grid.size(); ++i)
  {
    scene.grid.invalidate(static_cast<int>(i));
    scene.surroundings.invalidate(static_cast<int>(i));
  }
  const PoseEvidence evidence = evidenceOf(scene, poses[0]);
  EXPECT_EQ(evidence.unmeasured, evidence.facing);
  EXPECT_EQ(evidence.inlierShare(0.3), 0);
}

TEST(Outline, goesOnWhereTheSurfaceIsLarger)
{
  // A tee laid onto a wide plane at the height of its nearest points explains nothing there; its outline tells.
  DepthGrid flat = makeGrid(480, 384, test::smallCamera());
  for (int v = 0; v < flat.height; ++v)
    for (int u = 0; u < flat.width; ++u)
    {
      const Eigen::Vector3f p = flat.camera.backProject(u, v, 0.6).cast<float>();
      const auto i = static_cast<std::size_t>(flat.index(u, v));
      flat.x[i] = p.x();
      flat.y[i] = p.y();
      flat.z[i] = p.z();
    }
  const TrainedModel plate = plateModel();
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
  T.translation().z() = 0.6;
  const OutlineEvidence evidence = gatherOutlineEvidence(plate, allPoints(plate.surface), T, flat, 0.004, 0.004);
  EXPECT_EQ(evidence.ends, 0);
  EXPECT_GT(evidence.continues, 30);
  EXPECT_LT(evidence.share(), 0.1);
}

TEST(Outline, withoutDataItDecidesNothing)
{
  const DepthGrid nothing = makeGrid(480, 384, test::smallCamera());
  Pose T = Pose::Identity();
  T.translation().z() = 0.6;
  const OutlineEvidence evidence =
      gatherOutlineEvidence(plateModel(), allPoints(plateModel().surface), T, nothing, 0.004, 0.004);
  EXPECT_EQ(evidence.ends + evidence.continues, 0);
  EXPECT_NEAR(evidence.share(), 2.0 / 3, 1e-9);
}

// A block with a step: two terraces, each 30 mm by 60 mm, the lower one 30 mm below the upper one.
constexpr float TERRACE = 0.03f;

TrainedModel stepModel()
{
  TrainedModel step;
  step.mesh = test::angleMesh(2 * TERRACE, TERRACE, 2 * TERRACE);
  step.parameters.leaf = 0.004;
  step.parameters.normal_radius = 1.3 * step.parameters.leaf;
  step.center = Eigen::Vector3d::Constant(TERRACE);
  step.diameter = 2 * std::sqrt(3) * static_cast<double>(TERRACE);
  step.parameters.surface_spacing = 0.001;
  step.surface = sampleSurface(step.mesh, step.parameters.surface_spacing, 1);
  const double cell = step.parameters.leaf / 3;
  step.field = DistanceField(sampleSurface(step.mesh, cell / 2, 1), cell, 1.5 * step.parameters.leaf);
  return step;
}

/// The terraces face the camera, the upper one at 0.54 m.
Pose stepPose()
{
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(-0.03, -0.03, 0.6);
  return T;
}

/// Of a box above the step, its middle given in the step's frame.
TriangleMesh boxAt(float x, float y, float z, const Eigen::Vector3d& center, double tilt)
{
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = center;
  return test::moved(test::box(x, y, z), stepPose() * T);
}

double stepContinuedIn(const std::vector<TriangleMesh>& scene)
{
  const TrainedModel step = stepModel();
  DepthRenderer renderer(480, 384, test::smallCamera());
  for (const TriangleMesh& mesh : scene)
    renderer.draw(mesh, Pose::Identity(), 1);
  const DepthGrid grid = renderer.grid();
  const auto normals = estimateGridNormals(grid, step.parameters.normal_radius, Executor(1));
  return continuedShare(step, visiblePoints(step, stepPose()), stepPose(), grid, normals, 0.001);
}

TriangleMesh step() { return test::moved(stepModel().mesh, stepPose()); }

TEST(Continuation, ofThePartItselfThereIsNone) { EXPECT_LT(stepContinuedIn({step()}), 0.003); }

TEST(Continuation, aLargerBlockGoesOnWhereTheUpperTerraceEnds)
{
  // All of the upper terrace is explained. Of what goes on beyond it a strip counts that is not wider than a leaf: 4 mm
  // beside 30 mm. It is less, because a field of cells rounds the edge off.
  const TriangleMesh block = boxAt(0.06f, 0.06f, 0.06f, {0.03, 0.03, 0.03}, 0);
  const double share = stepContinuedIn({block});
  EXPECT_LT(share, 0.004 / 0.03);
  EXPECT_GT(share, 0.4 * 0.004 / 0.03);
}

TEST(Continuation, anotherBodyOnTheLowerTerraceHasASurfaceOfItsOwn)
{
  const Eigen::Vector3d middle(0.045, 0.045, 0.03);  // of the space above the lower terrace
  const TriangleMesh lower = boxAt(0.03f, 0.015f, 0.06f, middle, 0);
  EXPECT_LT(stepContinuedIn({step(), lower}), 0.003);
  const TriangleMesh tilted = boxAt(0.03f, 0.02f, 0.06f, middle + Eigen::Vector3d(0, 0.005, 0), M_PI / 5);
  EXPECT_LT(stepContinuedIn({step(), tilted}), 0.003);
}

TEST(Continuation, withoutDataThereIsNone) { EXPECT_EQ(stepContinuedIn({}), 0); }

TEST(CoveredCells, doNotDependOnTheReduction)
{
  const int width = 100;
  std::vector<int> fine;
  for (int v = 20; v < 60; ++v)
    for (int u = 30; u < 70; ++u)
      fine.push_back(v * width + u);
  std::vector<int> coarse;
  for (int v = 10; v < 30; ++v)
    for (int u = 15; u < 35; ++u)
      coarse.push_back(v * width / 2 + u);
  EXPECT_EQ(coveredCells(fine, width, 1, 5), coveredCells(coarse, width / 2, 2, 5));
  EXPECT_EQ(coveredCells(fine, width, 1, 5).size(), 64u);
}
}  // namespace
}  // namespace bin_picking
