// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// The judge of grips: scenes whose outcome follows from a drawing.
#include "grip_trial.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/part.hpp"
#include "core/grip_scenes.hpp"
#include "core/temporary_folder.hpp"

using namespace bin_picking;
using namespace bin_picking::simulation;
using namespace bin_picking::test;
using Outcome = GripVerdict::Outcome;

namespace
{
// 60 mm along x, 30 mm between the fingers, 25 mm high.
const TriangleMesh BLOCK = test::box(0.06f, 0.03f, 0.025f);
constexpr double REST = 0.0125;  // of its middle above the floor

/// The fingers end 8 mm below the tip: 4.5 mm above the floor.
constexpr double TIP = 0.0125;

GripPath middleGrip(const GripScenario& scenario, double y = 0) { return scenario.fromAbove({0, y, TIP}, 0.05, 0.03); }

/// A block whose two sides lean by an angle each, so that it is a wedge seen from above.
TriangleMesh wedge(double angle)
{
  std::vector<Eigen::Vector3d> corners;
  for (const double x : {-0.02, 0.02})
    for (const double side : {-1.0, 1.0})
      for (const double z : {-REST, REST})
        corners.emplace_back(x, side * (0.015 + std::tan(angle) * x), z);
  return toMesh(makeHull(corners));
}

void expectCollision(const GripVerdict& verdict, GripStage stage, GripObstacle obstacle, const std::string& body,
                     const std::string& what)
{
  EXPECT_EQ(verdict.outcome, Outcome::Collision) << verdict.what;
  EXPECT_EQ(verdict.stage, stage) << verdict.what;
  EXPECT_EQ(verdict.obstacle, obstacle) << verdict.what;
  EXPECT_EQ(verdict.body, body);
  EXPECT_EQ(verdict.obstacle_name, what);
  EXPECT_NE(verdict.what.find(body), std::string::npos) << verdict.what;
  EXPECT_NE(verdict.what.find(what), std::string::npos) << verdict.what;
}
}  // namespace

TEST(GripTrial, takesALoneBlock)
{
  GripScenario scene;
  const int id = scene.add(BLOCK, at(0, 0, REST));
  for (const int meant : {id, -1})
  {
    const GripVerdict verdict = scene.tryGrip(middleGrip(scene), meant);
    EXPECT_EQ(verdict.outcome, Outcome::Taken) << verdict.what;
    EXPECT_EQ(verdict.id, id);
    EXPECT_NEAR(verdict.final_opening, 0.03, scene.parameters.closing_step);
    EXPECT_NEAR(verdict.offset, 0, 1e-6);
    expectWords(verdict.what, {"part 0 (block)", "30.0 mm"});
  }
}

TEST(GripTrial, takesALoneTubeOnTheFloor)
{
  const PartDefinition tee = loadPart(std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/three_way_tube");
  GripScenario scene;
  // On its side: run along x, branch along y; its y points down.
  Pose T_bin_object = at(0.05, -0.02, 0.0175);
  T_bin_object.linear() = Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  scene.add(loadMesh(tee.mesh_file, tee.mesh_unit), T_bin_object, tee.name);
  int taken = 0;
  for (const GraspDefinition& grasp : tee.grasps)
  {
    const Pose T_bin_tip = T_bin_object * grasp.T_object_tip;
    if (T_bin_tip.linear()(2, 2) > -0.99 || grasp.id.rfind("collar", 0) != 0)
      continue;  // not from above, or where only slimmer fingers than these get
    GripPath path = scene.fromAbove(Eigen::Vector3d::Zero(), grasp.opening, grasp.width);
    path.T_bin_tool0_grasp = T_bin_tip * scene.gripper.T_tool0_tip(grasp.width).inverse();
    path.T_bin_tool0_pre_grasp = Eigen::Translation3d(0, 0, grasp.approach) * path.T_bin_tool0_grasp;
    path.T_bin_tool0_retreat = Eigen::Translation3d(0, 0, grasp.retreat) * path.T_bin_tool0_grasp;
    const GripVerdict verdict = scene.tryGrip(path, 0);
    EXPECT_EQ(verdict.outcome, Outcome::Taken) << grasp.id << ": " << verdict.what;
    EXPECT_NEAR(verdict.final_opening, grasp.width, 0.001) << grasp.id;
    ++taken;
  }
  EXPECT_EQ(taken, 2) << "an end of the run, and the branch";
}

TEST(GripTrial, tellsWhereTheFingerMeetsANeighbour)
{
  GripScenario scene;
  const int id = scene.add(BLOCK, at(0, 0, REST));
  scene.add(test::box(0.06f, 0.03f, 0.02f), at(0, 0.045, 0.01), "neighbour");
  const GripVerdict verdict = scene.tryGrip(middleGrip(scene), id);
  expectCollision(verdict, GripStage::Approach, GripObstacle::Part, "right finger", "part 1 (neighbour)");
  // The neighbour is 20 mm high, the finger ends at 4.5 mm, and stands 5 mm over it: between y = 25 and 35 mm.
  expectWords(verdict.what, {"15.5 mm before the grasp"});
  EXPECT_NEAR(verdict.depth, 0.005, 2e-4);
}

TEST(GripTrial, noSheetIsTooThinToBeHit)
{
  GripScenario scene;
  const int id = scene.add(BLOCK, at(0, 0, REST));
  scene.add(test::box(0.1f, 0.02f, 0.0002f), at(0, -0.04, 0.03), "sheet");
  const GripVerdict verdict = scene.tryGrip(middleGrip(scene), id);
  expectCollision(verdict, GripStage::Approach, GripObstacle::Part, "left finger", "part 1 (sheet)");
  expectWords(verdict.what, {"25.6 mm before the grasp"});  // 30.1 - 4.5 mm
}

TEST(GripTrial, slidesBesideANeighbourWithoutTouchingIt)
{
  GripScenario scene;
  const int id = scene.add(BLOCK, at(0, 0, REST));
  scene.add(BLOCK, at(0, 0.0501, REST), "neighbour");  // from y = 35.1 mm; the finger ends at 35
  EXPECT_EQ(scene.tryGrip(middleGrip(scene), id).outcome, Outcome::Taken);
}

TEST(GripTrial, hitsTheWallAndItsRim)
{
  GripScenario inside;
  const int in_wall = inside.add(BLOCK, at(0, 0.125, REST));  // the finger stands from y = 150 to 160 mm
  expectCollision(inside.tryGrip(middleGrip(inside, 0.125), in_wall), GripStage::Approach, GripObstacle::Bin,
                  "right finger", "wall at +y");
  GripScenario above;
  const int below_rim = above.add(BLOCK, at(0, 0.1, REST));  // the palm reaches to y = 160 mm and ends at 82.5
  const GripVerdict verdict = above.tryGrip(middleGrip(above, 0.1), below_rim);
  expectCollision(verdict, GripStage::Approach, GripObstacle::Bin, "palm", "wall at +y");
  expectWords(verdict.what, {"67.5 mm before the grasp"});
  GripScenario beside;
  const int free = beside.add(BLOCK, at(0, 0.0899, REST));  // 0.1 mm beside the wall
  EXPECT_EQ(beside.tryGrip(middleGrip(beside, 0.0899), free).outcome, Outcome::Taken);
}

TEST(GripTrial, hitsTheFloor)
{
  GripScenario scene;
  const int id = scene.add(BLOCK, at(0, 0, REST));
  const GripVerdict verdict = scene.tryGrip(scene.fromAbove({0, 0, 0.007}, 0.05, 0.03), id);
  EXPECT_EQ(verdict.outcome, Outcome::Collision);
  EXPECT_EQ(verdict.obstacle_name, "floor");
  expectWords(verdict.what, {"1.0 mm before the grasp"});
  EXPECT_EQ(scene.tryGrip(scene.fromAbove({0, 0, 0.0081}, 0.05, 0.03), id).outcome, Outcome::Taken);
}

TEST(GripTrial, thePalmCounts)
{
  GripScenario scene;
  const int id = scene.add(BLOCK, at(0, 0, REST));
  scene.add(test::box(0.005f, 0.005f, 0.1f), at(0.025, 0.04, 0.05), "post");  // beside the fingers, below the palm
  const GripVerdict verdict = scene.tryGrip(middleGrip(scene), id);
  expectCollision(verdict, GripStage::Approach, GripObstacle::Part, "palm", "part 1 (post)");
  expectWords(verdict.what, {"17.5 mm before"});  // the palm ends at 12.5 + 70 mm, the post at 100
}

TEST(GripTrial, tooNarrowAnOpeningLandsOnThePart)
{
  GripScenario scene;
  const int id = scene.add(test::box(0.06f, 0.046f, 0.025f), at(0, 0, REST));
  GripPath path = scene.fromAbove({0, 0, TIP}, 0.045, 0.03);
  const GripVerdict verdict = scene.tryGrip(path, id);
  EXPECT_EQ(verdict.outcome, Outcome::Collision);
  EXPECT_EQ(verdict.obstacle, GripObstacle::Target);
  EXPECT_EQ(verdict.id, id);
  expectWords(verdict.what, {"part to be held", "20.5 mm before"});
}

TEST(GripTrial, missesBesideThePart)
{
  GripScenario scene;
  const int id = scene.add(BLOCK, at(0, 0, REST));
  const GripVerdict verdict = scene.tryGrip(scene.fromAbove({0.0501, 0, TIP}, 0.05, 0.03), id);
  EXPECT_EQ(verdict.outcome, Outcome::Missed) << verdict.what;
  expectWords(verdict.what, {"closed to 27.0 mm", "do not hold part 0"});
  EXPECT_EQ(scene.tryGrip(scene.fromAbove({0.1, 0, TIP}, 0.05, 0.03), -1).id, -1);
}

TEST(GripTrial, pushesThePartToTheMiddleWithinLimits)
{
  GripScenario scene;
  const int id = scene.add(BLOCK, at(0, 0.003, REST));
  const GripVerdict pushed = scene.tryGrip(middleGrip(scene), id);
  EXPECT_EQ(pushed.outcome, Outcome::Taken) << pushed.what;
  EXPECT_NEAR(pushed.offset, -0.003, 2e-4) << "from y = 3 mm back to the middle";
  EXPECT_NEAR(pushed.final_opening, 0.03, scene.parameters.closing_step);

  scene.parameters.max_push = 0.0025;
  const GripVerdict too_far = scene.tryGrip(middleGrip(scene), id);
  EXPECT_EQ(too_far.outcome, Outcome::Missed);
  expectWords(too_far.what, {"more than 2.5 mm", "max_push"});
}

TEST(GripTrial, anotherWidthIsNoHold)
{
  GripScenario scene;
  const int id = scene.add(test::box(0.06f, 0.036f, 0.025f), at(0, 0, REST));
  const GripVerdict wide = scene.tryGrip(middleGrip(scene), id);
  EXPECT_EQ(wide.outcome, Outcome::Missed);
  expectWords(wide.what, {"stop on part 0 (block)", "instead of 30.0 mm"});
  GripScenario narrow;
  const int other = narrow.add(test::box(0.06f, 0.025f, 0.025f), at(0, 0, REST));
  EXPECT_EQ(narrow.tryGrip(middleGrip(narrow), other).outcome, Outcome::Missed);
}

TEST(GripTrial, slantedSidesSlipOutsideTheFrictionCone)
{
  // atan(0.4) = 21.8 degrees. The wedge is 30 mm across where the pads' middle is.
  for (const auto& [degrees, holds] : {std::pair<double, bool>{0, true}, {15, true}, {25, false}, {35, false}})
  {
    GripScenario scene;
    scene.parameters.max_width_error = 0.02;  // the broad end is met first
    const int id = scene.add(wedge(degrees * M_PI / 180), at(0, 0, REST));
    const GripVerdict verdict = scene.tryGrip(scene.fromAbove({0, 0, TIP}, 0.08, 0.03), id);
    EXPECT_EQ(verdict.outcome, holds ? Outcome::Taken : Outcome::Missed) << degrees << ": " << verdict.what;
    if (!holds)
      expectWords(verdict.what, {"slip off part 0 (block)", "22 deg"});
  }
}

TEST(GripTrial, contactsThatAreNotOppositeTurnThePart)
{
  // Each finger finds a face, but at ends that are far apart along x.
  GripScenario scene;
  scene.parameters.max_width_error = 0.01;
  scene.gripper.bodies[1].shape = makeBox({0, 0.005, 0.119}, {0.06, 0.01, 0.078});
  scene.gripper.bodies[2].shape = makeBox({0, -0.005, 0.119}, {0.06, 0.01, 0.078});
  std::vector<Eigen::Vector3d> corners;
  for (const double z : {-REST, REST})
    for (const double s : {1.0, -1.0})
    {
      corners.emplace_back(s * 0.03, s * 0.015, z);
      corners.emplace_back(s * 0.02, s * 0.015, z);
    }
  const int id = scene.add(toMesh(makeHull(corners)), at(0, 0, REST), "parallelogram");
  const GripVerdict verdict = scene.tryGrip(middleGrip(scene), id);
  EXPECT_EQ(verdict.outcome, Outcome::Missed) << verdict.what;
  expectWords(verdict.what, {"turn part 0 (parallelogram) away"});
}

TEST(GripTrial, closingMustNotTouchOthers)
{
  GripScenario scene;
  const int id = scene.add(BLOCK, at(0, 0, REST));
  scene.add(test::box(0.01f, 0.004f, 0.02f), at(0, 0.02, 0.01), "splinter");  // from y = 18 to 22 mm: inside
  const GripVerdict verdict = scene.tryGrip(middleGrip(scene), id);
  expectCollision(verdict, GripStage::Closing, GripObstacle::Part, "right finger", "part 1 (splinter)");
  expectWords(verdict.what, {"while closing"});
  EXPECT_NEAR(verdict.final_opening, 0.044, 3e-4);
}

TEST(GripTrial, theLinkageMustNotTouchThePart)
{
  GripScenario scene;
  const int id = scene.add(test::box(0.06f, 0.03f, 0.1f), at(0, 0, 0.05));
  scene.gripper.bodies[1].touches_part = false;
  const GripVerdict verdict = scene.tryGrip(scene.fromAbove({0, 0, 0.08}, 0.05, 0.03), id);
  expectCollision(verdict, GripStage::Closing, GripObstacle::Target, "right finger", "part 0 (block)");
}

TEST(GripTrial, theHeldPartRunsIntoTheWall)
{
  GripScenario scene;
  const int id = scene.add(test::box(0.12f, 0.03f, 0.025f), at(0.13, 0, REST), "bar");  // ends 10 mm from the wall
  GripPath path = scene.fromAbove({0.08, 0, TIP}, 0.05, 0.03);
  EXPECT_EQ(scene.tryGrip(path, id).outcome, Outcome::Taken);
  path.T_bin_tool0_retreat.translation().x() += 0.06;
  const GripVerdict verdict = scene.tryGrip(path, id);
  expectCollision(verdict, GripStage::Retreat, GripObstacle::Bin, "held part", "wall at +x");
  // After (10 mm + bin_play) of 60 along x: of the 134.2 mm of the way a share of 0.175.
  expectWords(verdict.what, {"23.5 mm after the grasp"});
}

TEST(GripTrial, shortWaysGoOnStraightUpOverTheRim)
{
  GripScenario scene;
  const int id = scene.add(BLOCK, at(0, 0, REST));
  GripPath still = middleGrip(scene);
  still.T_bin_tool0_pre_grasp = still.T_bin_tool0_retreat = still.T_bin_tool0_grasp;
  EXPECT_EQ(scene.tryGrip(still, id).outcome, Outcome::Taken) << "nothing lies above";

  // Over the whole gripper as it stands at the pre-grasp: it would have gone through it.
  scene.add(test::box(0.1f, 0.02f, 0.002f), at(0, 0.06, 0.2), "shelf");
  GripPath short_way = middleGrip(scene);
  short_way.T_bin_tool0_pre_grasp = Eigen::Translation3d(0, 0, 0.01) * short_way.T_bin_tool0_grasp;
  short_way.T_bin_tool0_retreat = short_way.T_bin_tool0_pre_grasp;
  const GripVerdict entered = scene.tryGrip(short_way, id);
  expectCollision(entered, GripStage::Approach, GripObstacle::Part, "palm", "part 1 (shelf)");
  expectWords(entered.what, {"on the way down into the bin", "before the pre-grasp"});
}

TEST(GripTrial, theHeldPartHasToGetOutOfTheBin)
{
  GripScenario scene;
  const int id = scene.add(test::box(0.12f, 0.03f, 0.025f), at(0.06, 0, REST), "bar");  // its end reaches to x = 120 mm
  scene.add(test::box(0.02f, 0.03f, 0.002f), at(0.11, 0, 0.101), "shelf");  // beside the gripper, 75 mm over the bar
  GripPath path = scene.fromAbove({0.02, 0, TIP}, 0.05, 0.03);
  path.T_bin_tool0_retreat = Eigen::Translation3d(0, 0, 0.05) * path.T_bin_tool0_grasp;
  const GripVerdict verdict = scene.tryGrip(path, id);
  expectCollision(verdict, GripStage::Retreat, GripObstacle::Part, "held part", "part 1 (shelf)");
  expectWords(verdict.what, {"on the way up out of the bin", "after the retreat"});
  scene.bodies.pop_back();
  EXPECT_EQ(scene.tryGrip(path, id).outcome, Outcome::Taken) << "a retreat shorter than the bin is deep is none";
}

TEST(GripTrial, thinWallsHoldTheHeldPartBack)
{
  // The play on both sides is as much as the wall is thick, or more.
  for (const double thickness : {0.0005, 0.001, 0.005})
  {
    GripScenario scene;
    scene.wall_thickness = thickness;
    const int id = scene.add(test::box(0.12f, 0.03f, 0.025f), at(0.13, 0, REST), "bar");
    GripPath path = scene.fromAbove({0.08, 0, TIP}, 0.05, 0.03);
    EXPECT_EQ(scene.tryGrip(path, id).outcome, Outcome::Taken) << thickness;
    path.T_bin_tool0_retreat.translation().x() += 0.06;
    const GripVerdict verdict = scene.tryGrip(path, id);
    expectCollision(verdict, GripStage::Retreat, GripObstacle::Bin, "held part", "wall at +x");
    expectWords(verdict.what, {"23.5 mm after the grasp"});
  }
}

TEST(GripTrial, aPartAgainstTheWallMayBeLiftedAlongIt)
{
  GripScenario scene;
  // It rests 0.3 mm deep in floor and wall, as physics may leave it.
  const int id = scene.add(test::box(0.12f, 0.03f, 0.025f), at(0.1403, 0, REST - 0.0003), "bar");
  EXPECT_EQ(scene.tryGrip(scene.fromAbove({0.08, 0, TIP}, 0.05, 0.03), id).outcome, Outcome::Taken);
}

TEST(GripTrial, aPartThatLiesAcrossIsDragged)
{
  GripScenario scene;
  const int id = scene.add(test::box(0.12f, 0.03f, 0.025f), at(0, 0, REST), "bar");
  scene.add(test::box(0.02f, 0.1f, 0.02f), at(0.05, 0, 0.035), "upper");
  const GripVerdict verdict = scene.tryGrip(middleGrip(scene), id);
  expectCollision(verdict, GripStage::Retreat, GripObstacle::Part, "held part", "part 1 (upper)");
  expectWords(verdict.what, {"drags", "max_drag", "after the grasp"});
  EXPECT_GT(verdict.depth, 0.001);
  EXPECT_LT(verdict.depth, 0.0021) << "the first step beyond 1 mm";
}

TEST(GripTrial, aNeighbourThatOnlyTouchesStays)
{
  GripScenario scene;
  const int id = scene.add(test::box(0.12f, 0.03f, 0.025f), at(0, 0, REST), "bar");
  scene.add(test::box(0.03f, 0.03f, 0.025f), at(0.0747, 0, REST), "neighbour");  // 0.3 mm deep in its end
  EXPECT_EQ(scene.tryGrip(middleGrip(scene), id).outcome, Outcome::Taken);
}

TEST(GripTrial, theGripperHitsOthersOnTheWayOut)
{
  GripScenario scene;
  const int id = scene.add(BLOCK, at(0, 0, REST));
  scene.add(test::box(0.02f, 0.02f, 0.14f), at(0.08, 0, 0.07), "post");
  GripPath path = middleGrip(scene);
  path.T_bin_tool0_retreat.translation() += Eigen::Vector3d(0.06, 0, -0.06);
  const GripVerdict verdict = scene.tryGrip(path, id);
  EXPECT_EQ(verdict.stage, GripStage::Retreat);
  EXPECT_EQ(verdict.outcome, Outcome::Collision);
  EXPECT_EQ(verdict.obstacle_name, "part 1 (post)");
}

TEST(GripTrial, beginningInsideAPartIsACollision)
{
  GripScenario scene;
  const int id = scene.add(BLOCK, at(0, 0, REST));
  scene.add(test::box(0.35f, 0.25f, 0.402f), at(0, 0, 0.203), "cabinet");  // swallows the whole gripper
  GripPath path = middleGrip(scene);
  path.T_bin_tool0_pre_grasp = path.T_bin_tool0_grasp;
  const GripVerdict verdict = scene.tryGrip(path, id);
  EXPECT_EQ(verdict.outcome, Outcome::Collision);
  EXPECT_EQ(verdict.obstacle_name, "part 1 (cabinet)");
}

TEST(GripTrial, suctionNeedsTheWholeLipOnASurface)
{
  GripScenario scene;
  scene.gripper = suctionCup();
  const int id = scene.add(BLOCK, at(0, 0, REST));
  const auto grip = [&](double x, double z) { return scene.tryGrip(scene.fromAbove({x, 0, z}, 0, 0), id); };
  EXPECT_EQ(grip(0, 0.025).outcome, Outcome::Taken) << grip(0, 0.025).what;
  EXPECT_EQ(grip(0, 0.0265).outcome, Outcome::Taken) << "the lip reaches a little";
  EXPECT_EQ(grip(0, 0.0275).outcome, Outcome::Missed);
  EXPECT_EQ(grip(0.025, 0.025).outcome, Outcome::Missed) << "over the edge";
  expectWords(grip(0.025, 0.025).what, {"does not seal"});
  EXPECT_EQ(grip(0.1, 0.025).outcome, Outcome::Missed);

  GripPath leaning = scene.fromAbove({0, 0, 0.025}, 0, 0);
  const Pose about_tip = at(0, 0, 0.025) * Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()) * at(0, 0, -0.025);
  for (Pose* pose : {&leaning.T_bin_tool0_pre_grasp, &leaning.T_bin_tool0_grasp, &leaning.T_bin_tool0_retreat})
    *pose = about_tip * *pose;
  EXPECT_EQ(scene.tryGrip(leaning, id).outcome, Outcome::Taken);
  scene.parameters.seal_angle = 0.05;
  expectWords(scene.tryGrip(leaning, id).what, {"leans", "seal_angle"});
}

TEST(GripTrial, refusesWhatNoRobotCanDo)
{
  GripScenario scene;
  const int id = scene.add(BLOCK, at(0, 0, REST));
  const auto message = [&](const GripPath& path, int meant) {
    return messageOf<ParameterError>([&] { scene.tryGrip(path, meant); });
  };
  GripPath path = middleGrip(scene);
  path.opening = 0.12;
  expectWords(message(path, id), {"120.0 mm", "two_fingers", "100.0 mm"});
  path = middleGrip(scene);
  path.width = 0.06;
  expectWords(message(path, id), {"60.0 mm", "less than its opening"});
  path.width = std::numeric_limits<double>::quiet_NaN();
  expectWords(message(path, id), {"width"});
  path = middleGrip(scene);
  path.T_bin_tool0_retreat.linear() = at(0, 0, 0, 0.1).linear() * path.T_bin_tool0_retreat.linear();
  expectWords(message(path, id), {"retreat is turned", "5.7"});
  path = middleGrip(scene);
  path.T_bin_tool0_pre_grasp.translation().x() = std::numeric_limits<double>::quiet_NaN();
  expectWords(message(path, id), {"pre-grasp", "finite"});
  expectWords(message(middleGrip(scene), 77), {"77"});
  scene.gripper.bodies[1].touches_part = scene.gripper.bodies[2].touches_part = false;
  expectWords(message(middleGrip(scene), id), {"touches_part"});
}
