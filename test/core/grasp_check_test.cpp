// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/grasp_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/grasping/grasp_proposal.hpp"
#include "mesh_shapes.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using Eigen::Vector3d;
using test::expectWords;
using test::messageOf;
using Fault = GraspCheck::Fault;

constexpr double DEGREE = M_PI / 180;

/// Fingers 20 mm wide (X) and 15 mm thick, from 60 mm behind the tip to 5 mm beyond it; a palm above.
Gripper plainGripper()
{
  Gripper gripper;
  gripper.name = "plain";
  gripper.max_opening = 0.08;
  gripper.tip_heights = {{0, 0.15}, {0.08, 0.15}};
  for (const double side : {1.0, -1.0})
  {
    GripperBody finger;
    finger.name = side > 0 ? "right finger" : "left finger";
    finger.shape = makeBox(Vector3d(0, side * 0.0075, 0.1225), Vector3d(0.02, 0.015, 0.065));
    finger.placements = {{0, Vector3d::Zero(), 0}, {0.08, Vector3d(0, side * 0.04, 0), 0}};
    finger.touches_part = true;
    gripper.bodies.push_back(finger);
  }
  GripperBody palm;
  palm.name = "palm";
  palm.shape = makeBox(Vector3d(0, 0, 0.045), Vector3d(0.06, 0.12, 0.09));
  gripper.bodies.push_back(palm);
  return gripper;
}

/// From above (+z of the part), closing along y.
GraspDefinition fromAbove(double width)
{
  GraspDefinition grasp;
  grasp.id = "from_above";
  grasp.T_object_tip.linear() = Vector3d(1, -1, -1).asDiagonal();
  grasp.width = width;
  grasp.opening = width + 0.02;
  return grasp;
}

class BoxOf40x30x20 : public testing::Test
{
protected:
  bool has(const GraspCheck& check, Fault fault, const std::vector<std::string>& words)
  {
    for (const auto& finding : check.findings)
      if (finding.fault == fault)
      {
        expectWords(finding.sentence, words);
        return true;
      }
    return false;
  }

  const TriangleMesh mesh_ = test::box(0.04f, 0.03f, 0.02f);
  const Gripper gripper_ = plainGripper();
  const GraspChecker checker_{mesh_, gripper_};
};

TEST_F(BoxOf40x30x20, aGoodGraspHoldsAndIsMeasured)
{
  const GraspCheck check = checker_.check(fromAbove(0.03));
  EXPECT_TRUE(check.good()) << check.findings.front().sentence;
  EXPECT_NEAR(check.width, 0.03, 1e-6);
  EXPECT_NEAR(check.offset, 0, 1e-6);
  // The pads cover 20 mm along x and, from the top of the box at 10 mm to 5 mm below the tip, 15 mm along z.
  EXPECT_NEAR(check.right.area, 300e-6, 20e-6);
  EXPECT_NEAR(check.left.area, 300e-6, 20e-6);
  EXPECT_NEAR(check.right.angle, 0, 1e-6);
  EXPECT_NEAR(check.right.center.y(), 0.015, 1e-6);
  EXPECT_NEAR(check.clearance, 0.01, 1e-6);  // fingers come down 10 mm beside it
}

TEST_F(BoxOf40x30x20, aWrongWidthIsToldWithTheRightOne)
{
  const GraspCheck check = checker_.check(fromAbove(0.026));
  EXPECT_TRUE(has(check, Fault::Width, {"30.0 mm wide", "not 26.0 mm", "write width: 0.0300"}));
  EXPECT_EQ(check.findings.size(), 1u);
}

TEST_F(BoxOf40x30x20, aTipOffTheMiddleIsToldWithTheRightPosition)
{
  GraspDefinition grasp = fromAbove(0.03);
  grasp.T_object_tip.translation() = Vector3d(0.003, 0.002, 0.001);
  const GraspCheck check = checker_.check(grasp);
  EXPECT_NEAR(check.offset, 0.002, 1e-6);  // closing is -y of the part: its middle lies at +2 mm of the tip
  EXPECT_TRUE(has(check, Fault::OffCentre, {"2.0 mm off", "towards +closing", "[0.0030, 0.0000, 0.0010]"}));
}

TEST_F(BoxOf40x30x20, aNarrowOpeningRunsIntoThePart)
{
  GraspDefinition grasp = fromAbove(0.03);
  grasp.opening = 0.0312;
  EXPECT_TRUE(has(checker_.check(grasp), Fault::WayIn, {"would pass at 0.6 mm", "finger", "write opening: 0.032"}));
}

TEST_F(BoxOf40x30x20, whatTheGripperCannotDoIsTold)
{
  GraspDefinition grasp = fromAbove(0.03);
  grasp.opening = 0.1;
  EXPECT_TRUE(has(checker_.check(grasp), Fault::Opening, {"100.0 mm", "'plain' opens to 80.0 mm"}));
}

TEST_F(BoxOf40x30x20, airIsNotHeld)
{
  GraspDefinition grasp = fromAbove(0.03);
  grasp.T_object_tip.translation().z() = 0.05;
  const GraspCheck check = checker_.check(grasp);
  EXPECT_TRUE(std::isnan(check.width));
  EXPECT_TRUE(has(check, Fault::Nothing, {"meets no surface", "50.0 mm"}));
}

// Turned by 30 degrees about x, the pads meet two opposite edges of the box: nothing that friction holds.
TEST_F(BoxOf40x30x20, edgesAreNotHeld)
{
  GraspDefinition grasp = fromAbove(0.0359);
  grasp.T_object_tip.linear() = grasp.T_object_tip.linear() * Eigen::AngleAxisd(30 * DEGREE, Vector3d::UnitX());
  const GraspCheck check = checker_.check(grasp);
  EXPECT_TRUE(has(check, Fault::Contact, {"21.8 deg of friction", "mm^2"}));
}

TEST_F(BoxOf40x30x20, aStepBesideTheGraspIsHitOnTheWay)
{
  TriangleMesh stepped = mesh_;  // a plate below, 100 mm wide, its top 3 mm below the tip
  TriangleMesh plate = test::box(0.1f, 0.1f, 0.004f);
  for (auto& triangle : plate.triangles)
    for (auto& corner : triangle)
      corner += static_cast<std::uint32_t>(stepped.vertices.size());
  for (const auto& vertex : plate.vertices)
    stepped.vertices.emplace_back(vertex - Eigen::Vector3f(0, 0, 0.005f));
  stepped.triangles.insert(stepped.triangles.end(), plate.triangles.begin(), plate.triangles.end());
  const GraspChecker checker(stepped, gripper_);
  const GraspCheck check = checker.check(fromAbove(0.03));
  EXPECT_LT(check.clearance, -0.0015);  // the fingers end 5 mm below the tip
  EXPECT_TRUE(has(check, Fault::WayIn, {"would cut 2.0 mm", "grasp less deep", "0.0030]"}));
}

TEST_F(BoxOf40x30x20, tolerancesMustHoldToo)
{
  GraspDefinition grasp = fromAbove(0.03);
  grasp.tilt_tolerance = 20 * DEGREE;
  EXPECT_TRUE(checker_.check(grasp).good());
  grasp.spin_tolerance = 20 * DEGREE;  // turned, the box is wider between the pads
  EXPECT_TRUE(has(checker_.check(grasp), Fault::Width, {"spin of 10.0 deg", "less tolerance"}));
}

TEST_F(BoxOf40x30x20, whatHardlyMissesItsLimitIsToldApartFromIt)
{
  GraspDefinition grasp = fromAbove(0.03);
  grasp.opening = 0.03199;
  EXPECT_TRUE(has(checker_.check(grasp), Fault::WayIn, {"would pass at 0.99 mm", "at least 1.00 mm"}));
  grasp.opening = 0.08001;
  EXPECT_TRUE(has(checker_.check(grasp), Fault::Opening, {"an opening of 80.01 mm", "opens to 80.00 mm"}));
}

TEST_F(BoxOf40x30x20, aGraspForASuctionCupIsNoneForFingers)
{
  GraspDefinition grasp = fromAbove(0.03);
  grasp.width = grasp.opening = 0;
  const GraspCheck check = checker_.check(grasp);
  EXPECT_TRUE(has(check, Fault::Opening, {"suction cup", "its opening is 0", "the 'plain' has fingers", "write"}));
  EXPECT_EQ(check.findings.size(), 1u);
}

TEST_F(BoxOf40x30x20, theTightestTurnIsToldWithItsPlace)
{
  GraspDefinition grasp = fromAbove(0.03);
  grasp.spin_tolerance = 2 * DEGREE;
  grasp.opening = 0.034;
  const GraspCheck upright = checker_.check(grasp, grasp.T_object_tip);
  const GraspCheck all = checker_.check(grasp);
  ASSERT_TRUE(all.good()) << all.findings.front().sentence;
  double smallest = upright.clearance;
  bool found = false;
  for (const GraspVariant& variant : expandTolerances(grasp))
  {
    const GraspCheck turned = checker_.check(grasp, variant.T_object_tip);
    smallest = std::min(smallest, turned.clearance);
    found = found ||
            (turned.clearance == all.clearance && turned.closest == all.closest && turned.closest_at == all.closest_at);
  }
  EXPECT_EQ(all.clearance, smallest);
  EXPECT_LT(smallest, upright.clearance);
  EXPECT_TRUE(found);
}

/// The box with a fin of 6 x 0.3 x 16 mm beside it, its middle at (15, y, 8) mm.
TriangleMesh withFin(TriangleMesh mesh, float y)
{
  TriangleMesh fin = test::box(0.006f, 0.0003f, 0.016f);
  for (auto& triangle : fin.triangles)
    for (auto& corner : triangle)
      corner += static_cast<std::uint32_t>(mesh.vertices.size());
  for (const auto& vertex : fin.vertices)
    mesh.vertices.emplace_back(vertex + Eigen::Vector3f(0.015f, y, 0.008f));
  mesh.triangles.insert(mesh.triangles.end(), fin.triangles.begin(), fin.triangles.end());
  return mesh;
}

TEST_F(BoxOf40x30x20, whatIsNoPadMustMissThePartWhileClosing)
{
  // Beside each pad a blade of 0.6 mm, 2.4 mm inside of its face, that passes 2 mm above the box.
  Gripper bladed = gripper_;
  for (const double side : {1.0, -1.0})
  {
    GripperBody blade;
    blade.name = side > 0 ? "right blade" : "left blade";
    blade.shape = makeBox(Vector3d(0.015, -side * 0.0027, 0.134), Vector3d(0.006, 0.0006, 0.008));
    blade.placements = {{0, Vector3d::Zero(), 0}, {0.08, Vector3d(0, side * 0.04, 0), 0}};
    bladed.bodies.push_back(blade);
  }
  EXPECT_TRUE(GraspChecker(mesh_, bladed).check(fromAbove(0.03)).good());
  // A fin in its way, thinner than the steps of any sampling; closing is -y of the part.
  for (const float y : {0.0178f, -0.0178f, 0.0163f, 0.0167f})
  {
    const TriangleMesh finned = withFin(mesh_, y);
    EXPECT_TRUE(GraspChecker(finned, gripper_).check(fromAbove(0.03)).good()) << "the pads pass beside it";
    EXPECT_TRUE(has(GraspChecker(finned, bladed).check(fromAbove(0.03)), Fault::Closing,
                    {y < 0 ? "right blade" : "left blade", "while the fingers close"}))
        << y;
  }
}

TEST_F(BoxOf40x30x20, padsOnOneSideHoldNothing)
{
  Gripper one_sided = gripper_;
  one_sided.bodies[1] = one_sided.bodies[0];
  expectWords(messageOf<ParameterError>([&] { GraspChecker(mesh_, one_sided); }),
              {"'plain'", "one side of its tip", "mark the pad of the other finger"});
  Gripper turned = gripper_;  // the tip closes along X, where both fingers are in the middle
  turned.tip_xy = {0.05, 0};
  turned.R_tool0_tip = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ()).toRotationMatrix();
  expectWords(messageOf<ParameterError>([&] { GraspChecker(mesh_, turned); }), {"one side of its tip"});
}

TEST_F(BoxOf40x30x20, aSuctionCupIsNotChecked)
{
  Gripper cup = gripper_;
  cup.kind = Gripper::Kind::Suction;
  expectWords(messageOf<ParameterError>([&] { GraspChecker(mesh_, cup); }), {"suction cup"});
  expectWords(messageOf<ParameterError>([&] { GraspChecker(TriangleMesh(), gripper_); }), {"no triangles"});
}

// A ball is 24 mm wide wherever it is taken; what lies within the compliance is a cap of radius sqrt(2 r h).
TEST(GraspCheckOfABall, isMeasured)
{
  const TriangleMesh ball = test::sphereMesh(0.012f, 5);
  const Gripper gripper = plainGripper();
  const GraspChecker checker(ball, gripper);
  GraspDefinition grasp = fromAbove(0.024);
  grasp.tilt_tolerance = 45 * DEGREE;
  grasp.spin_tolerance = 180 * DEGREE;
  const GraspCheck check = checker.check(grasp);
  EXPECT_TRUE(check.good()) << check.findings.front().sentence;
  EXPECT_NEAR(check.width, 0.024, 5e-5);  // rays up to 0.35 mm beside the farthest point, flat facets
  // The cap is round, cut off 5 mm beyond the tip only.
  EXPECT_NEAR(check.right.area, M_PI * 2 * 0.012 * 0.0003, 4e-6);
}

TEST(AttitudeCoverage, oneApproachTakesACap)
{
  std::vector<GraspVariant> variants(1);
  EXPECT_NEAR(attitudeCoverage(variants, M_PI / 4), (1 - std::cos(M_PI / 4)) / 2, 0.005);
  EXPECT_NEAR(attitudeCoverage(variants, M_PI), 1, 1e-9);
  EXPECT_EQ(attitudeCoverage({}, M_PI / 4), 0);
}

TEST_F(BoxOf40x30x20, proposalsAreGoodAndReadBack)
{
  PartDefinition part;
  const Executor one(1), two(2);
  const auto proposed = proposeGrasps(part, mesh_, gripper_, {}, 5, one);
  ASSERT_GE(proposed.size(), 3u);
  part.grasps = proposed;
  EXPECT_GT(attitudeCoverage(expandGrasps(part, 1), M_PI / 4), 0.5);
  const std::string yaml = graspsToYaml(proposed);
  EXPECT_EQ(yaml, graspsToYaml(proposeGrasps(PartDefinition(), mesh_, gripper_, {}, 5, two)));

  const test::TemporaryFolder folder;
  const PartDefinition read =
      loadPart(folder.write("part.yaml", "format: 1\nname: box\nmesh: {file: box.stl, unit: mm}\n" + yaml));
  ASSERT_EQ(read.grasps.size(), proposed.size());
  for (std::size_t k = 0; k < read.grasps.size(); ++k)
  {
    EXPECT_LT((read.grasps[k].T_object_tip.matrix() - proposed[k].T_object_tip.matrix()).cwiseAbs().maxCoeff(), 1e-4);
    const GraspCheck check = checker_.check(read.grasps[k]);
    EXPECT_TRUE(check.good()) << check.findings.front().sentence;
  }
}

TEST(GraspCheckParameters, documentationHasEveryOne)
{
  GraspCheckParameters parameters;
  checkRanges(parameters);
  const std::string page = test::readFile(std::string(BIN_PICKING_SOURCE_DIR) + "/docs/own_part.md");
  const std::string table = toMarkdown(visitor(parameters));
  EXPECT_NE(page.find(table), std::string::npos) << "docs/own_part.md must have this table:\n" << table;
}
}  // namespace
}  // namespace bin_picking
