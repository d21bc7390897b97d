// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/near_symmetry.hpp"
#include "bin_picking_perception/model/symmetry_search.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "mesh_shapes.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using Eigen::Vector3d;
using test::moved;
using test::tubeMesh;

constexpr double LEAF = 0.004;
constexpr double SPACING = LEAF / 4;
constexpr double TOLERANCE = LEAF / 10;

/// An attitude in which no axis of the shape is one of the drawing, far from its origin.
Pose askew()
{
  return Pose(Eigen::Translation3d(0.02, -0.05, 0.03) * Eigen::AngleAxisd(0.9, Vector3d(1, -2, 3).normalized()));
}

SymmetryReport search(const TriangleMesh& mesh)
{
  const OrientedPoints dense = sampleSurface(mesh, SPACING, 1);
  std::vector<int> queries;
  for (std::size_t i = 0; i < dense.size(); i += 4)
    queries.push_back(static_cast<int>(i));
  const DistanceField field(dense, LEAF / 3, 1.5 * LEAF);
  return findSymmetry(SelfComparison(dense, queries, SPACING, 2 * SPACING), field, TOLERANCE);
}

void expectMember(const SymmetryReport& report, const Pose& T)
{
  // Half a degree turns a part of 100 mm by less than its tolerance of 0.4 mm.
  for (const Pose& element : report.symmetry.discrete)
    if (Eigen::AngleAxisd(element.linear().transpose() * T.linear()).angle() < 0.01)
      return;
  ADD_FAILURE() << "not found:\n" << T.matrix();
}

/// A solid prism or cylinder; the bore of radius 0 has no area.
TriangleMesh prism(int sides) { return tubeMesh(0.02f, 0, 0.06f, sides); }

TriangleMesh joined(TriangleMesh a, const TriangleMesh& b)
{
  const auto offset = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles)
    a.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  return a;
}

constexpr int TEETH = 16;  // a tooth every 22.5 degrees

/// A gear about z with teeth 3 mm high.
TriangleMesh gear()
{
  constexpr int SIDES = 4 * TEETH;
  TriangleMesh mesh = tubeMesh(0.03f, 0, 0.02f, SIDES);
  for (Eigen::Vector3f& v : mesh.vertices)
  {
    const auto side = static_cast<int>(std::lround(std::atan2(v.y(), v.x()) / (2 * M_PI) * SIDES) + SIDES);
    if (side % 4 >= 2)
      v.head<2>() *= 0.9f;
  }
  return mesh;
}

/// The gear with a boss beside its axis, which tells its teeth apart.
TriangleMesh gearWithBoss(double height, const Pose& T, float width = 0.008f, double beside = 0.022)
{
  Pose at = Pose::Identity();
  at.translation() = Vector3d(beside, 0.004, 0.02 + height / 2);
  return moved(joined(gear(), moved(test::box(width, width, static_cast<float>(height)), at)), T);
}

std::vector<NearSymmetry> nearSymmetriesOf(const TriangleMesh& mesh, double slight_deviation)
{
  const OrientedPoints dense = sampleSurface(mesh, SPACING, 1);
  const DistanceField field(dense, LEAF / 3, 1.5 * LEAF);
  std::vector<int> queries;
  for (std::size_t i = 0; i < dense.size(); i += 16)
    queries.push_back(static_cast<int>(i));
  const SelfComparison exact(dense, queries, SPACING, 4 * SPACING);
  return findNearSymmetries(dense, field, exact, {}, 0.35 * LEAF, slight_deviation);
}

/// The one that is the turn to within a quarter of a degree.
const NearSymmetry* turnedAlike(const std::vector<NearSymmetry>& near, const Pose& turn)
{
  const auto found = std::find_if(near.begin(), near.end(), [&](const NearSymmetry& one) {
    return Eigen::AngleAxisd(one.T_object_object.linear().transpose() * turn.linear()).angle() < 0.004;
  });
  return found == near.end() ? nullptr : &*found;
}

TEST(SymmetrySearch, AGearHasAsManyTurnsAsTeeth)
{
  for (const Pose& T : {Pose::Identity(), askew()})
  {
    const SymmetryReport report = search(moved(gear(), T));
    EXPECT_FALSE(report.symmetry.continuous);
    EXPECT_EQ(report.symmetry.discrete.size(), 2u * TEETH);
    expectMember(report, rotationAbout({T.linear() * Vector3d::UnitZ(), T * Vector3d::Zero()}, 2 * M_PI / TEETH));
  }
}

TEST(SymmetrySearch, WhatIsAlmostSymmetricTellsTheAxisOfTheRest)
{
  for (const Pose& T : {Pose::Identity(), askew()})
  {
    const SymmetryReport report = search(gearWithBoss(0.006, T));
    EXPECT_TRUE(report.symmetry.trivial());
    ASSERT_FALSE(report.almost.empty());
    const AxisFinding& almost = report.almost.front();
    EXPECT_EQ(almost.order, TEETH);
    // The boss draws the middle of the area 0.5 mm aside.
    const Vector3d off_axis = (almost.axis.origin - T * Vector3d::Zero()).cross(T.linear() * Vector3d::UnitZ());
    EXPECT_LT(off_axis.norm(), 1e-4);
    EXPECT_GT(std::abs(almost.axis.direction.dot(T.linear() * Vector3d::UnitZ())), std::cos(0.002));
    EXPECT_NEAR(almost.mismatch.deviation, 0.006, TOLERANCE);  // the top of the boss
    EXPECT_LT(almost.mismatch.share, 0.1);
  }
}

TEST(NearSymmetry, AGearWithABossNearlyKeepsTheTurnsOfItsTeeth)
{
  const auto near = nearSymmetriesOf(gearWithBoss(0.002, askew()), 0.0025);
  const Symmetry::Axis axis{askew().linear() * Vector3d::UnitZ(), askew() * Vector3d::Zero()};
  for (int tooth = 1; tooth < TEETH; ++tooth)
  {
    const Pose turn = rotationAbout(axis, 2 * M_PI * tooth / TEETH);
    const NearSymmetry* found = turnedAlike(near, turn);
    ASSERT_NE(found, nullptr) << tooth;
    const Vector3d rim = askew() * Vector3d(0.03, 0, 0.01);
    EXPECT_LT((found->T_object_object * rim - turn * rim).norm(), 2e-4) << tooth;
    EXPECT_TRUE(found->slight) << "the boss is 2 mm high";
    EXPECT_FALSE(found->slight_all_around) << "half a tooth moves the teeth, 3 mm high";
  }
}

TEST(NearSymmetry, ASmallFeatureMayStandOutTwiceAsFar)
{
  // The boss is 6 mm high, the teeth 3 mm, and half of one moves the boss by 3 mm.
  constexpr double SLIGHT = 0.0045;
  constexpr double BESIDE = 0.012;
  const auto tooth = [](int k) { return rotationAbout({Vector3d::UnitZ(), Vector3d::Zero()}, 2 * M_PI * k / TEETH); };
  const auto small = nearSymmetriesOf(gearWithBoss(0.006, Pose::Identity(), 0.008f, BESIDE), SLIGHT);
  const auto wide = nearSymmetriesOf(gearWithBoss(0.006, Pose::Identity(), 0.022f, BESIDE), SLIGHT);
  const auto high = nearSymmetriesOf(gearWithBoss(0.012, Pose::Identity(), 0.008f, BESIDE), SLIGHT);
  for (int k = 1; k < TEETH; ++k)
  {
    const NearSymmetry* found = turnedAlike(small, tooth(k));
    ASSERT_NE(found, nullptr) << k;
    EXPECT_TRUE(found->slight) << k << ": also the next teeth, which are turned by little";
    EXPECT_FALSE(found->slight_all_around) << k;
  }
  for (const auto* other : {&wide, &high})
  {
    const NearSymmetry* found = turnedAlike(*other, tooth(TEETH / 2));
    ASSERT_NE(found, nullptr);
    EXPECT_FALSE(found->slight) << "breaks " << found->broken << ", moves " << found->deviation;
  }
}

TEST(SymmetrySearch, ACylinderTurnsAboutItsAxisAndFlips)
{
  for (const Pose& T : {Pose::Identity(), askew()})
  {
    const SymmetryReport report = search(moved(prism(64), T));  // facets of 0.02 mm
    ASSERT_TRUE(report.symmetry.continuous);
    EXPECT_GT(std::abs(report.symmetry.continuous->direction.dot(T.linear() * Vector3d::UnitZ())), 0.99998);
    const Vector3d offset = report.symmetry.continuous->origin - T * Vector3d::Zero();
    EXPECT_LT(offset.cross(report.symmetry.continuous->direction).norm(), TOLERANCE);
    EXPECT_EQ(report.symmetry.discrete.size(), 2u);
    EXPECT_FALSE(report.round);
    EXPECT_LT(report.found.front().mismatch.deviation, TOLERANCE);
  }
}

TEST(SymmetrySearch, ACupTurnsButDoesNotFlip)
{
  const SymmetryReport report = search(joined(prism(64), tubeMesh(0.03f, 0, 0.006f, 64)));
  ASSERT_TRUE(report.symmetry.continuous);
  EXPECT_EQ(report.symmetry.discrete.size(), 1u);
}

TEST(SymmetrySearch, AHexagonalPrismHasTwelveRotations)
{
  for (const Pose& T : {Pose::Identity(), askew()})
  {
    const SymmetryReport report = search(moved(prism(6), T));
    EXPECT_FALSE(report.symmetry.continuous);
    EXPECT_EQ(report.symmetry.discrete.size(), 12u);
    const Symmetry::Axis axis{T.linear() * Vector3d::UnitZ(), T * Vector3d(0, 0, 0.03)};
    for (int k = 1; k < 6; ++k)
      expectMember(report, rotationAbout(axis, k * M_PI / 3));
    expectMember(report, rotationAbout({T.linear() * Vector3d::UnitX(), axis.origin}, M_PI));
  }
}

TEST(SymmetrySearch, BoxesHaveFourEightOrTwentyFourRotations)
{
  EXPECT_EQ(search(test::box(0.05f, 0.03f, 0.08f)).symmetry.discrete.size(), 4u);
  EXPECT_EQ(search(test::box(0.05f, 0.05f, 0.08f)).symmetry.discrete.size(), 8u);
  EXPECT_EQ(search(test::box(0.05f, 0.05f, 0.05f)).symmetry.discrete.size(), 24u);
  EXPECT_EQ(search(moved(test::box(0.05f, 0.03f, 0.08f), askew())).symmetry.discrete.size(), 4u);
  EXPECT_EQ(search(moved(test::box(0.05f, 0.05f, 0.08f), askew())).symmetry.discrete.size(), 8u);
  EXPECT_EQ(search(moved(test::box(0.05f, 0.05f, 0.05f), askew())).symmetry.discrete.size(), 24u);
}

TEST(SymmetrySearch, ABallIsRound)
{
  const SymmetryReport report = search(test::sphereMesh(0.03f, 4));
  EXPECT_TRUE(report.round);
  EXPECT_TRUE(report.symmetry.continuous);
  EXPECT_TRUE(report.almost.empty());
}

TEST(SymmetrySearch, ATeeHasOneHalfTurn)
{
  // A run along z and a branch along x, of other diameters.
  Pose branch = Pose::Identity();
  branch.linear() = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY()).toRotationMatrix();
  Pose run = Pose::Identity();
  run.translation() = Vector3d(0, 0, -0.03);
  const TriangleMesh tee = joined(moved(prism(64), run), moved(tubeMesh(0.012f, 0, 0.05f, 64), branch));
  for (const Pose& T : {Pose::Identity(), askew()})
  {
    const SymmetryReport report = search(moved(tee, T));
    EXPECT_FALSE(report.symmetry.continuous);
    ASSERT_EQ(report.symmetry.discrete.size(), 2u);
    expectMember(report, rotationAbout({T.linear() * Vector3d::UnitX(), T * Vector3d::Zero()}, M_PI));
  }
}

TEST(SymmetrySearch, AnUnequalAngleHasNone)
{
  // Its legs are equal, but a half turn that swaps them exchanges their inner and outer faces: about x + y it fits.
  const SymmetryReport equal = search(test::angleMesh(0.05f, 0.01f, 0.03f));
  EXPECT_EQ(equal.symmetry.discrete.size(), 2u);
  TriangleMesh mesh = test::angleMesh(0.05f, 0.01f, 0.03f);
  for (Eigen::Vector3f& v : mesh.vertices)
    v.x() = v.x() > 0.04f ? 0.07f : v.x();
  const SymmetryReport report = search(mesh);
  EXPECT_TRUE(report.symmetry.trivial());
  EXPECT_TRUE(report.found.empty());
}

TEST(SymmetrySearch, ACamTellsHowMuchBreaksItsRevolution)
{
  // A key of 20 mm along the shaft that stands out by 4 mm.
  Pose at = Pose::Identity();
  at.translation() = Vector3d(0.02, 0, 0.03);
  const SymmetryReport report = search(joined(prism(64), moved(test::box(0.008f, 0.006f, 0.02f), at)));
  EXPECT_TRUE(report.symmetry.trivial() || report.symmetry.discrete.size() == 2u);  // the half turn about the key
  ASSERT_FALSE(report.almost.empty());
  const AxisFinding& almost = report.almost.front();
  EXPECT_EQ(almost.order, AxisFinding::CONTINUOUS);
  EXPECT_GT(std::abs(almost.axis.direction.z()), 0.999);
  EXPECT_NEAR(almost.mismatch.deviation, 0.004, TOLERANCE);
  EXPECT_NEAR(almost.mismatch.region, 0.021, 0.004);  // the diagonal of the key's top
  EXPECT_LT(almost.mismatch.share, 0.1);
}

PartDefinition definitionOf(const test::TemporaryFolder& folder, const TriangleMesh& mesh)
{
  PartDefinition part;
  part.name = "shape";
  part.mesh_file = folder.path("shape.stl");
  std::ofstream(part.mesh_file, std::ios::binary) << test::binaryStl(mesh, "shape");
  return part;
}

TEST(NearSymmetry, TrainingSaysWhatMayBeLeftOpen)
{
  const test::TemporaryFolder folder;
  TrainingParameters parameters;
  parameters.leaf = LEAF;
  parameters.num_views = 32;
  // The diameter is 67 mm: 3.4 mm are slight, and 6.7 mm of a small feature.
  const auto remarks = [&](double height) {
    std::string text;
    const PartDefinition part = definitionOf(folder, gearWithBoss(height, Pose::Identity()));
    const auto model = trainPart(part, parameters, Executor(2));
    for (const std::string& remark : model->remarks)
      text += remark + "\n";
    return text;
  };
  const std::string small = remarks(0.005);
  EXPECT_NE(small.find("may be left open where a view does not tell"), std::string::npos) << small;
  EXPECT_NE(small.find(" is slight, 6."), std::string::npos) << small;
  const std::string high = remarks(0.012);
  EXPECT_NE(high.find("no turn may be left open"), std::string::npos) << high;
}

TEST(SymmetrySearch, TrainingUsesWhatItFindsUnlessThePartStatesIt)
{
  const test::TemporaryFolder folder;
  TrainingParameters parameters;
  parameters.leaf = LEAF;
  parameters.num_views = 32;
  PartDefinition part = definitionOf(folder, prism(6));
  EXPECT_EQ(trainPart(part, parameters, Executor(2))->symmetry.discrete.size(), 12u);
  EXPECT_EQ(symmetryOf(part, Executor(2)).discrete.size(), 12u);
  part.symmetry_stated = true;
  EXPECT_TRUE(trainPart(part, parameters, Executor(2))->symmetry.trivial());
  EXPECT_TRUE(symmetryOf(part, Executor(2)).trivial());
  part.symmetry.discrete = closeUnderComposition({rotationAbout({Vector3d::UnitZ(), Vector3d::Zero()}, M_PI / 2)});
  const auto contradicted = trainPart(part, parameters, Executor(2));
  EXPECT_EQ(contradicted->symmetry.discrete.size(), 4u);
  std::string remarks;
  for (const std::string& remark : contradicted->remarks)
    remarks += remark + "\n";
  // A quarter turn of a hexagon of radius 20 mm takes corners onto sides: 20 (1 - cos 30 degrees) = 2.68 mm.
  test::expectWords(remarks, {"contradicts", "2.6", "0.40 mm"});
}
}  // namespace
}  // namespace bin_picking
