// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/refinement/verification.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "bin_picking_perception/scene/preprocessing.hpp"
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
