// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// The parts of config/parts: meshes, declared symmetries and grasps hold against each other.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "bin_picking_perception/grasping/grasp_check.hpp"
#include "bin_picking_perception/grasping/grasp_proposal.hpp"
#include "bin_picking_perception/grasping/gripper.hpp"
#include "bin_picking_perception/model/mesh.hpp"
#include "bin_picking_perception/model/models_info.hpp"
#include "bin_picking_perception/model/part.hpp"
#include "surface_distance.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using Eigen::Vector3d;

const std::string CONFIG = std::string(BIN_PICKING_SOURCE_DIR) + "/config/";
const std::vector<std::string> PARTS = {"cast_handle",   "hex_bolt",       "l_bracket",     "pipe_elbow",
                                        "stepped_shaft", "three_way_tube", "upright_column"};

/// The facets have the symmetry of the part; what is left are the rounded coordinates of the files, 1 um.
constexpr double SAME_SURFACE = 2e-5;
/// The smallest feature that breaks a near symmetry of these parts: 2.8 mm from a corner of the bolt to the next flat.
constexpr double OTHER_SURFACE = 1e-3;

struct Part
{
  PartDefinition definition;
  TriangleMesh mesh;
};

Part load(const std::string& name)
{
  Part part;
  part.definition = loadPart(CONFIG + "parts/" + name);
  part.mesh = loadMesh(part.definition.mesh_file, part.definition.mesh_unit);
  return part;
}

Pose turn(double angle, const Vector3d& axis, const Vector3d& origin)
{
  return Pose(Eigen::Translation3d(origin) * Eigen::AngleAxisd(angle, axis) * Eigen::Translation3d(-origin));
}

/// Centre and principal axes of the solid, from tetrahedra over its triangles. Each symmetry keeps both.
struct Inertia
{
  Vector3d center = Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
};

Inertia inertiaOf(const TriangleMesh& mesh)
{
  double volume = 0;
  Vector3d first = Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const auto& t : mesh.triangles)
  {
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k)
      corners.col(k) = mesh.vertices[t[static_cast<std::size_t>(k)]].cast<double>();
    const double tetrahedron = corners.determinant() / 6;
    const Vector3d sum = corners.rowwise().sum();
    volume += tetrahedron;
    first += tetrahedron * sum / 4;
    second += tetrahedron * (corners * corners.transpose() + sum * sum.transpose()) / 20;
  }
  Inertia inertia;
  inertia.center = first / volume;
  const Eigen::Matrix3d covariance = second / volume - inertia.center * inertia.center.transpose();
  inertia.axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
  return inertia;
}

/// Turns by 360 degrees / order about each principal axis, and half turns about axes across it in steps of 15 degrees:
/// with three different moments of inertia the half turns about the principal axes are all there can be, with two equal
/// ones turns about the third axis and half turns across it.
std::vector<Pose> candidates(const Inertia& inertia)
{
  std::vector<Pose> poses;
  for (int k = 0; k < 3; ++k)
  {
    const Vector3d axis = inertia.axes.col(k);
    for (const int order : {2, 3, 4, 5, 6, 8, 12})
      poses.push_back(turn(2 * M_PI / order, axis, inertia.center));
    for (int step = 1; step < 12; ++step)
      poses.push_back(
          turn(M_PI, Eigen::AngleAxisd(step * M_PI / 12, axis) * inertia.axes.col((k + 1) % 3), inertia.center));
  }
  return poses;
}

bool isDeclared(const Pose& candidate, const Symmetry& symmetry)
{
  return std::any_of(symmetry.discrete.begin(), symmetry.discrete.end(),
                     [&](const Pose& g) { return (g.matrix() - candidate.matrix()).cwiseAbs().maxCoeff() < 1e-3; });
}

class DemoPart : public testing::TestWithParam<std::string>
{
};

TEST_P(DemoPart, meshIsClosedOutwardAndOfTheExpectedSize)
{
  const Part part = load(GetParam());
  EXPECT_EQ(part.definition.name, GetParam());
  const MeshReport report = inspectMesh(part.mesh);
  EXPECT_TRUE(report.warnings.empty()) << report.warnings.front();  // also what loadMesh repaired: inside out, ...
  EXPECT_EQ(report.open_edges, 0);
  EXPECT_EQ(report.degenerate_triangles, 0);
  EXPECT_GT(report.volume, 0);
  ASSERT_TRUE(part.definition.expected_size);
  EXPECT_NO_THROW(checkExpectedSize(part.definition, report.size));
}

TEST_P(DemoPart, declaredRotationsMapTheSurfaceOntoItself)
{
  const Part part = load(GetParam());
  const OrientedPoints samples = sampleSurface(part.mesh, 0.003, 1);
  for (const Pose& element : part.definition.symmetry.sampled(12))
    EXPECT_LT(test::largestSurfaceDistance(transformed(samples, element).points, part.mesh), SAME_SURFACE)
        << element.matrix();
}

TEST_P(DemoPart, noSymmetryIsForgotten)
{
  const Part part = load(GetParam());
  ASSERT_FALSE(part.definition.symmetry.continuous);  // none of the candidates would then be informative
  const OrientedPoints samples = sampleSurface(part.mesh, 0.003, 1);
  for (const Pose& candidate : candidates(inertiaOf(part.mesh)))
  {
    if (isDeclared(candidate, part.definition.symmetry))
      continue;
    const auto points = transformed(samples, candidate).points;
    EXPECT_GT(test::largestSurfaceDistance(points, part.mesh, OTHER_SURFACE), OTHER_SURFACE)
        << "this rotation is a symmetry that is not declared:\n"
        << candidate.matrix();
  }
}

/// The points of the surface that the finger at +Y, which holds, meets between the open fingers, as their extent along
/// Y. Tip frame.
std::pair<float, float> extentBetweenFingers(const std::vector<Eigen::Vector3f>& points_tip, const ConvexBody& finger,
                                             const GraspDefinition& grasp)
{
  std::pair<float, float> extent(std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity());
  const ConvexBody path =
      swept(swept(finger, {0, (grasp.opening - grasp.width) / 2, 0}), {0, -(grasp.opening + grasp.width) / 2, 0});
  for (const Eigen::Vector3f& p : points_tip)
  {
    if (signedDistance(path, p.cast<double>()) > 0)
      continue;
    extent.first = std::min(extent.first, p.y());
    extent.second = std::max(extent.second, p.y());
  }
  return extent;
}

/// A body of the gripper in the frame of the tip when it holds.
ConvexBody bodyInTip(const Gripper& gripper, std::size_t body, double opening, double width)
{
  return transformed(gripper.bodyAt(body, opening), gripper.T_tool0_tip(width).inverse());
}

/// Whether the gripper, open, runs into the part on its straight way to the grasp.
bool hitsOnTheWay(const std::vector<Eigen::Vector3f>& points_tip, const ConvexBody& body, const GraspDefinition& grasp)
{
  const ConvexBody path = swept(body, {0, 0, -grasp.approach});
  return std::any_of(points_tip.begin(), points_tip.end(),
                     [&](const Eigen::Vector3f& p) { return signedDistance(path, p.cast<double>()) < 0; });
}

TEST_P(DemoPart, fingersCloseOnThePartAndMissItOnTheWay)
{
  const Part part = load(GetParam());
  const Gripper gripper = loadGripper(CONFIG + "grippers/ag95.yaml");
  const auto finger =
      std::find_if(gripper.bodies.begin(), gripper.bodies.end(), [](const auto& b) { return b.touches_part; });
  ASSERT_NE(finger, gripper.bodies.end());
  const auto finger_index = static_cast<std::size_t>(finger - gripper.bodies.begin());
  const OrientedPoints samples = sampleSurface(part.mesh, 0.0005, 1);
  EXPECT_GE(part.definition.grasps.size(), 3u);
  for (const GraspDefinition& grasp : part.definition.grasps)
  {
    const auto points_tip = transformed(samples, grasp.T_object_tip.inverse()).points;
    EXPECT_LE(grasp.opening, gripper.max_opening) << grasp.id;
    for (std::size_t i = 0; i < gripper.bodies.size(); ++i)
      EXPECT_FALSE(hitsOnTheWay(points_tip, bodyInTip(gripper, i, grasp.opening, grasp.width), grasp))
          << grasp.id << ": " << gripper.bodies[i].name;
    // The width is written in whole millimetres; with a finger off by more than that the part would be pushed aside.
    const auto [low, high] =
        extentBetweenFingers(points_tip, bodyInTip(gripper, finger_index, grasp.width, grasp.width), grasp);
    EXPECT_NEAR(low, -grasp.width / 2, 0.001) << grasp.id;
    EXPECT_NEAR(high, grasp.width / 2, 0.001) << grasp.id;
  }
}

// With all that symmetry and tolerances allow, a part that lies anyhow can nearly always be taken from above.
TEST_P(DemoPart, graspsHoldAndServeMostAttitudes)
{
  const Part part = load(GetParam());
  const Gripper gripper = loadGripper(CONFIG + "grippers/ag95.yaml");
  const GraspChecker checker(part.mesh, gripper);
  for (const GraspDefinition& grasp : part.definition.grasps)
    for (const auto& finding : checker.check(grasp).findings)
      ADD_FAILURE() << grasp.id << ": " << finding.sentence;
  EXPECT_GT(attitudeCoverage(expandGrasps(part.definition, 12), M_PI / 4), 0.9);
}

INSTANTIATE_TEST_SUITE_P(All, DemoPart, testing::ValuesIn(PARTS), [](const auto& test) { return test.param; });

TEST(DemoParts, everyFolderIsTested)
{
  std::vector<std::string> folders;
  for (const auto& entry : std::filesystem::directory_iterator(CONFIG + "parts"))
    if (entry.is_directory())
      folders.push_back(entry.path().filename().string());
  std::sort(folders.begin(), folders.end());
  EXPECT_EQ(folders, PARTS);
}

TEST(DemoParts, symmetriesSurviveModelsInfo)
{
  std::map<int, ModelInfo> models;
  for (std::size_t i = 0; i < PARTS.size(); ++i)
  {
    const Part part = load(PARTS[i]);
    models[static_cast<int>(i)] = describeModel(part.mesh, part.definition.symmetry);
  }
  const test::TemporaryFolder folder;
  saveModelsInfo(models, folder.path("models_info.json"));
  const auto again = loadModelsInfo(folder.path("models_info.json"));
  ASSERT_EQ(again.size(), models.size());
  for (const auto& [id, info] : models)
  {
    const std::vector<Pose>& discrete = again.at(id).symmetry.discrete;
    EXPECT_FALSE(again.at(id).symmetry.continuous);
    ASSERT_EQ(discrete.size(), info.symmetry.discrete.size()) << PARTS[static_cast<std::size_t>(id)];
    for (std::size_t i = 0; i < discrete.size(); ++i)
      EXPECT_LT((discrete[i].matrix() - info.symmetry.discrete[i].matrix()).norm(), 1e-9);  // 12 decimals are written
    EXPECT_NEAR(again.at(id).diameter, info.diameter, 1e-12);
  }
}
}  // namespace
}  // namespace bin_picking
