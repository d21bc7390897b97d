// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/grasp_planner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
using Eigen::AngleAxisd;
using Eigen::Translation3d;
using Eigen::Vector3d;

constexpr double DEGREE = M_PI / 180;

GripperBody boxBody(const std::string& name, const Vector3d& center_tip, const Vector3d& size, int finger)
{
  GripperBody body;
  body.name = name;
  body.shape = makeBox(center_tip + 0.2 * Vector3d::UnitZ(), size);  // the tip is 0.2 m in front of the flange
  body.placements = {{0, {0, 0, 0}, 0}, {0.095, {0, finger * 0.0475, 0}, 0}};
  body.touches_part = finger != 0;
  return body;
}

/// Palm 100 mm above the tips and two fingers of 10 x 6 x 80 mm that end 10 mm beyond them.
Gripper twoFingerGripper()
{
  Gripper gripper;
  gripper.name = "two_finger";
  gripper.max_opening = 0.095;
  gripper.tip_heights = {{0, 0.2}};
  gripper.bodies = {boxBody("palm", {0, 0, -0.12}, {0.06, 0.12, 0.04}, 0),
                    boxBody("finger +", {0, 0.003, -0.03}, {0.01, 0.006, 0.08}, 1),
                    boxBody("finger -", {0, -0.003, -0.03}, {0.01, 0.006, 0.08}, -1)};
  return gripper;
}

/// A bin of 400 x 300 x 150 mm, 0.9 m in front of a camera that looks straight down.
Bin binBelowCamera()
{
  Bin bin;
  bin.T_camera_bin = Translation3d(0, 0, 0.9) * AngleAxisd(M_PI, Vector3d::UnitX());
  bin.inner_size = {0.4, 0.3, 0.15};
  return bin;
}

/// Taken from above at its origin: in the part frame the approach is -z, the fingers close along y.
GraspDefinition graspFromAbove(const std::string& id)
{
  GraspDefinition grasp;
  grasp.id = id;
  grasp.T_object_tip = Pose(AngleAxisd(M_PI, Vector3d::UnitX()));
  grasp.width = 0.03;
  grasp.opening = 0.05;
  return grasp;
}

PartDefinition partWith(const std::vector<GraspDefinition>& grasps)
{
  PartDefinition part;
  part.name = "part";
  part.grasps = grasps;
  return part;
}

/// A part in the bin, its z axis upwards before `rotation`.
Detection detectionAt(const Vector3d& position_bin, const Eigen::Quaterniond& rotation = Eigen::Quaterniond::Identity())
{
  Detection detection;
  detection.part = "part";
  detection.T_camera_object = binBelowCamera().T_camera_bin * Translation3d(position_bin) * rotation;
  detection.score = 0.9;
  detection.matching_rate = 0.97;
  return detection;
}

/// A block of 20 x 28 x 20 mm round the origin, as far as grasping looks at it.
std::shared_ptr<const TrainedModel> blockModel()
{
  TrainedModel model;
  model.name = "part";
  for (double u = -1; u <= 1.001; u += 0.1)
    for (double v = -1; v <= 1.001; v += 0.1)
      for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0})
        {
          Vector3d p;
          p[axis] = side;
          p[(axis + 1) % 3] = u;
          p[(axis + 2) % 3] = v;
          model.surface.points.push_back(p.cwiseProduct(Vector3d(0.010, 0.014, 0.010)).cast<float>());
          model.surface.normals.push_back((side * Vector3d::Unit(axis)).cast<float>());
        }
  model.points = model.surface;
  model.size = {0.020, 0.028, 0.020};
  model.diameter = model.size.norm();
  model.field = DistanceField(model.surface, 0.002, 0.008);
  return std::make_shared<const TrainedModel>(std::move(model));
}

/// What the camera over the bin sees: the floor, and of each block of 20 x 28 x 20 mm the top. Pixels 1.5 mm apart on
/// the floor. \param blocks middle, bin frame, sides along the bin
std::shared_ptr<const DepthGrid> pictureOf(const std::vector<Vector3d>& blocks)
{
  PinholeCamera camera;
  camera.fx = camera.fy = 600;
  camera.cx = 159.5;
  camera.cy = 119.5;
  DepthGrid grid = makeGrid(320, 240, camera);
  const Pose T_bin_camera = binBelowCamera().T_camera_bin.inverse();
  for (int v = 0; v < grid.height; ++v)
    for (int u = 0; u < grid.width; ++u)
    {
      Vector3d p = camera.backProject(u, v, 0.9);
      for (const Vector3d& block : blocks)
      {
        const Vector3d on_top = camera.backProject(u, v, 0.9 - block.z() - 0.010);
        const Vector3d off = (T_bin_camera * on_top - block).cwiseAbs();
        if (off.x() <= 0.010 && off.y() <= 0.014 && on_top.z() < p.z())
          p = on_top;
      }
      const auto i = static_cast<std::size_t>(grid.index(u, v));
      grid.x[i] = static_cast<float>(p.x());
      grid.y[i] = static_cast<float>(p.y());
      grid.z[i] = static_cast<float>(p.z());
    }
  return std::make_shared<const DepthGrid>(std::move(grid));
}

/// Without robot and without cloud.
GraspSelection planWith(const std::vector<Detection>& detections, const std::vector<PartDefinition>& parts,
                        const Gripper& gripper, const Bin* bin, const GraspParameters& parameters,
                        const GraspPlanner::Request& request = {})
{
  DetectionResult result;
  result.detections = detections;
  const std::vector<std::shared_ptr<const TrainedModel>> models = {blockModel()};
  return GraspPlanner({parts, gripper, std::nullopt, parameters, 1})
      .plan({result, models, bin, std::nullopt, true}, request);
}

GraspSelection selectInBin(const std::vector<Detection>& detections, const PartDefinition& part,
                           const GraspParameters& parameters = {})
{
  const Bin bin = binBelowCamera();
  return planWith(detections, {part}, twoFingerGripper(), &bin, parameters);
}

Vector3d inBin(const Pose& T_camera_tip)
{
  return binBelowCamera().T_camera_bin.inverse() * T_camera_tip.translation();
}

TEST(GraspPlanner, APartInTheMiddleIsTakenStraightDown)
{
  GraspDefinition definition = graspFromAbove("top");
  definition.approach = 0.08;
  definition.retreat = 0.12;
  const GraspSelection selection = selectInBin({detectionAt({0.02, -0.01, 0.015})}, partWith({definition}));
  ASSERT_EQ(selection.grasps.size(), 1u);
  EXPECT_TRUE(selection.rejected.empty());
  const Grasp& grasp = selection.grasps[0];
  EXPECT_EQ(grasp.part, "part");
  EXPECT_EQ(grasp.grasp_id, "top");
  EXPECT_TRUE(inBin(grasp.tip.grasp).isApprox(Vector3d(0.02, -0.01, 0.015), 1e-12));
  EXPECT_TRUE(inBin(grasp.tip.pre_grasp).isApprox(Vector3d(0.02, -0.01, 0.095), 1e-12));
  EXPECT_TRUE(inBin(grasp.tip.retreat).isApprox(Vector3d(0.02, -0.01, 0.135), 1e-12));
  EXPECT_TRUE(grasp.tip.pre_grasp.linear().isApprox(grasp.tip.grasp.linear()));
  EXPECT_TRUE(grasp.tip.retreat.linear().isApprox(grasp.tip.grasp.linear()));
  EXPECT_NEAR(grasp.tilt, 0, 1e-7);
  // The fingers end 10 mm below the tips: 5 mm above the floor, which is nearer than any wall.
  EXPECT_TRUE(grasp.collision_checked);
  EXPECT_NEAR(grasp.clearance.distance, 0.005, 1e-9);
  EXPECT_EQ(grasp.clearance.kind, ObstacleKind::BinFloor);
  EXPECT_FALSE(grasp.reach_checked);
  EXPECT_GT(grasp.quality, 0);
  EXPECT_LE(grasp.quality, 1);
  EXPECT_EQ(grasp.rejection, GraspRejection::None);
  EXPECT_TRUE(grasp.reason.empty());
}

TEST(GraspPlanner, TheObjectInTheHandIsConsistentWithTheDetection)
{
  PartDefinition part = partWith({graspFromAbove("top")});
  part.grasps[0].T_object_tip = Translation3d(0.01, 0.005, 0.005) * part.grasps[0].T_object_tip;
  part.symmetry.discrete.emplace_back(AngleAxisd(M_PI, Vector3d::UnitZ()));
  const Detection detection = detectionAt({0, 0, 0.06}, Eigen::Quaterniond(AngleAxisd(0.3, Vector3d::UnitX())));
  const GraspSelection selection = selectInBin({detection}, part);
  ASSERT_EQ(selection.grasps.size(), 2u);
  for (const Grasp& grasp : selection.grasps)
    EXPECT_TRUE((grasp.tip.grasp * grasp.T_tip_object).isApprox(detection.T_camera_object, 1e-12));
}

TEST(GraspPlanner, SymmetricCopiesAreDistinctPosesThatHoldTheSameGeometry)
{
  // A flat part that equals itself after half a turn about z. It is taken off-centre, by a corner feature.
  PartDefinition part = partWith({graspFromAbove("corner")});
  part.grasps[0].T_object_tip = Translation3d(0.03, 0.01, 0) * part.grasps[0].T_object_tip;
  part.symmetry.discrete.emplace_back(AngleAxisd(M_PI, Vector3d::UnitZ()));
  const std::vector<Vector3d> surface = {{0.03, 0.01, 0.0},  {-0.03, -0.01, 0.0}, {0.04, 0.0, 0.01},
                                         {-0.04, 0.0, 0.01}, {0.01, 0.02, -0.01}, {-0.01, -0.02, -0.01}};
  const Detection detection = detectionAt({0, 0, 0.06});
  const GraspSelection selection = selectInBin({detection}, part);
  ASSERT_EQ(selection.grasps.size(), 2u);
  EXPECT_NE(selection.grasps[0].symmetry_variant, selection.grasps[1].symmetry_variant);
  EXPECT_NEAR((selection.grasps[0].tip.grasp.translation() - selection.grasps[1].tip.grasp.translation()).norm(),
              2 * std::hypot(0.03, 0.01), 1e-9);

  // Seen from the fingers, the measured surface is the same for every copy.
  for (const Vector3d& p : surface)
  {
    const Vector3d as_written = part.grasps[0].T_object_tip.inverse() * p;
    for (const Grasp& grasp : selection.grasps)
    {
      double nearest = std::numeric_limits<double>::infinity();
      for (const Vector3d& q : surface)
        nearest = std::min(nearest, (grasp.tip.grasp.inverse() * detection.T_camera_object * q - as_written).norm());
      EXPECT_NEAR(nearest, 0, 1e-9);
    }
  }
}

TEST(GraspPlanner, VariantZeroIsTheGraspAsWritten)
{
  PartDefinition part = partWith({graspFromAbove("top")});
  part.symmetry.discrete.emplace_back(AngleAxisd(M_PI, Vector3d::UnitZ()));
  part.grasps[0].symmetric = false;
  const Detection detection = detectionAt({0, 0, 0.06});
  const GraspSelection selection = selectInBin({detection}, part);
  ASSERT_EQ(selection.grasps.size(), 1u);
  EXPECT_EQ(selection.grasps[0].symmetry_variant, 0);
  EXPECT_TRUE(selection.grasps[0].tip.grasp.isApprox(detection.T_camera_object * part.grasps[0].T_object_tip, 1e-12));
}

TEST(GraspPlanner, AnAxisOfRevolutionOffersItsSteps)
{
  PartDefinition part = partWith({graspFromAbove("top")});
  part.symmetry.continuous = Symmetry::Axis{Vector3d::UnitZ(), Vector3d::Zero()};
  GraspParameters parameters;
  parameters.continuous_symmetry_steps = 8;
  EXPECT_EQ(selectInBin({detectionAt({0, 0, 0.06})}, part, parameters).grasps.size(), 8u);
}

TEST(GraspPlanner, TiltIsMeasuredAgainstStraightDownAndLimited)
{
  GraspParameters parameters;
  parameters.max_tilt = 30 * DEGREE;
  const auto tilted = [](double x, double degrees) {
    return detectionAt({x, 0, 0.1}, Eigen::Quaterniond(AngleAxisd(degrees * DEGREE, Vector3d::UnitX())));
  };
  const GraspSelection selection =
      selectInBin({tilted(-0.08, 29.9), tilted(0.08, 30.1)}, partWith({graspFromAbove("top")}), parameters);
  ASSERT_EQ(selection.grasps.size(), 1u);
  ASSERT_EQ(selection.rejected.size(), 1u);
  EXPECT_EQ(selection.grasps[0].detection_index, 0u);
  EXPECT_NEAR(selection.grasps[0].tilt, 29.9 * DEGREE, 1e-9);
  EXPECT_EQ(selection.rejected[0].rejection, GraspRejection::TiltTooLarge);
  EXPECT_NE(selection.rejected[0].reason.find("30.1 deg"), std::string::npos) << selection.rejected[0].reason;
  EXPECT_NE(selection.rejected[0].reason.find("30.0 deg"), std::string::npos) << selection.rejected[0].reason;
}

TEST(GraspPlanner, ATiltedRetreatStillGoesStraightUp)
{
  const Detection detection = detectionAt({0, 0, 0.1}, Eigen::Quaterniond(AngleAxisd(0.5, Vector3d::UnitX())));
  const GraspSelection selection = selectInBin({detection}, partWith({graspFromAbove("top")}));
  ASSERT_EQ(selection.grasps.size(), 1u);
  const Grasp& grasp = selection.grasps[0];
  EXPECT_TRUE((inBin(grasp.tip.retreat) - inBin(grasp.tip.grasp)).isApprox(Vector3d(0, 0, 0.1), 1e-9));
  const Vector3d approach_bin = inBin(grasp.tip.grasp) - inBin(grasp.tip.pre_grasp);
  EXPECT_TRUE(approach_bin.isApprox(0.08 * Vector3d(0, std::sin(0.5), -std::cos(0.5)), 1e-9))
      << approach_bin.transpose();
}

TEST(GraspPlanner, FingersMustNotTouchAWall)
{
  // The outer face of a finger is opening / 2 + 6 mm = 31 mm from the tips, along y; the wall is at 150 mm. The palm is
  // wider, but 100 mm above the tips and so 20 mm above the rim.
  const PartDefinition part = partWith({graspFromAbove("top")});
  const double touching = 0.15 - 0.031;
  const GraspSelection free = selectInBin({detectionAt({0, touching - 0.004, 0.07})}, part);
  ASSERT_EQ(free.grasps.size(), 1u);
  EXPECT_NEAR(free.grasps[0].clearance.distance, 0.004, 1e-9);

  const GraspSelection near_wall = selectInBin({detectionAt({0, touching - 0.002, 0.07})}, part);
  ASSERT_EQ(near_wall.rejected.size(), 1u);
  EXPECT_EQ(near_wall.rejected[0].rejection, GraspRejection::BinWallCollision);
  EXPECT_NE(near_wall.rejected[0].reason.find("2.0 mm"), std::string::npos) << near_wall.rejected[0].reason;
  EXPECT_NE(near_wall.rejected[0].reason.find("wall at +y"), std::string::npos) << near_wall.rejected[0].reason;

  const GraspSelection in_wall = selectInBin({detectionAt({0, touching + 0.005, 0.07})}, part);
  ASSERT_EQ(in_wall.rejected.size(), 1u);
  EXPECT_EQ(in_wall.rejected[0].rejection, GraspRejection::BinWallCollision);
  EXPECT_LT(in_wall.rejected[0].clearance.distance, 0);
}

TEST(GraspPlanner, WhatHardlyMissesItsLimitIsToldApartFromIt)
{
  const PartDefinition part = partWith({graspFromAbove("top")});
  const GraspSelection near_wall = selectInBin({detectionAt({0, 0.15 - 0.031 - 0.00299, 0.07})}, part);
  ASSERT_EQ(near_wall.rejected.size(), 1u);
  EXPECT_NE(near_wall.rejected[0].reason.find("pass at 2.99 mm from"), std::string::npos)
      << near_wall.rejected[0].reason;
  EXPECT_NE(near_wall.rejected[0].reason.find("at least 3.00 mm"), std::string::npos) << near_wall.rejected[0].reason;
  GraspParameters parameters;
  parameters.max_tilt = 30 * DEGREE;
  const Eigen::Quaterniond leaning(AngleAxisd(30.02 * DEGREE, Vector3d::UnitX()));
  const GraspSelection tilted = selectInBin({detectionAt({0, 0, 0.1}, leaning)}, part, parameters);
  ASSERT_EQ(tilted.rejected.size(), 1u);
  EXPECT_NE(tilted.rejected[0].reason.find("30.02 deg"), std::string::npos) << tilted.rejected[0].reason;
  EXPECT_NE(tilted.rejected[0].reason.find("30.00 deg"), std::string::npos) << tilted.rejected[0].reason;
}

TEST(GraspPlanner, EveryWallAndItsCornersAreThere)
{
  PartDefinition across = partWith({graspFromAbove("along_x"), graspFromAbove("along_y")});
  across.grasps[0].T_object_tip = across.grasps[0].T_object_tip * AngleAxisd(M_PI / 2, Vector3d::UnitZ());
  const struct
  {
    Vector3d position;
    std::string wall;
  } cases[] = {{{0.19, 0, 0.07}, "wall at +x"},
               {{-0.19, 0, 0.07}, "wall at -x"},
               {{0, 0.14, 0.07}, "wall at +y"},
               {{0, -0.14, 0.07}, "wall at -y"}};
  for (const auto& c : cases)
  {
    const GraspSelection selection = selectInBin({detectionAt(c.position)}, across);
    ASSERT_EQ(selection.rejected.size(), 1u) << c.wall;  // the fingers that close along the wall pass
    EXPECT_NE(selection.rejected[0].reason.find(c.wall), std::string::npos) << selection.rejected[0].reason;
  }
  for (const double x : {-0.19, 0.19})
    for (const double y : {-0.14, 0.14})
      EXPECT_EQ(selectInBin({detectionAt({x, y, 0.07})}, across).rejected.size(), 2u);
}

TEST(GraspPlanner, TurningTheFingersAlongTheWallFreesAGrasp)
{
  // The same part at the same place: across the wall it is blocked, along the wall the fingers reach 5 mm aside.
  PartDefinition part = partWith({graspFromAbove("across"), graspFromAbove("along")});
  part.grasps[1].T_object_tip = part.grasps[1].T_object_tip * AngleAxisd(M_PI / 2, Vector3d::UnitZ());
  const GraspSelection selection = selectInBin({detectionAt({0, 0.13, 0.07})}, part);
  ASSERT_EQ(selection.grasps.size(), 1u);
  EXPECT_EQ(selection.grasps[0].grasp_id, "along");
  ASSERT_EQ(selection.rejected.size(), 1u);
  EXPECT_EQ(selection.rejected[0].grasp_id, "across");
}

TEST(GraspPlanner, AWideOpeningCollidesWhereANarrowOneDoesNot)
{
  PartDefinition part = partWith({graspFromAbove("narrow"), graspFromAbove("wide")});
  part.grasps[1].opening = 0.09;
  const GraspSelection selection = selectInBin({detectionAt({0, 0.11, 0.07})}, part);
  ASSERT_EQ(selection.grasps.size(), 1u);
  EXPECT_EQ(selection.grasps[0].grasp_id, "narrow");
}

TEST(GraspPlanner, FingersMustNotReachTheFloor)
{
  const PartDefinition part = partWith({graspFromAbove("top")});
  EXPECT_EQ(selectInBin({detectionAt({0, 0, 0.0135})}, part).grasps.size(), 1u);
  const GraspSelection low = selectInBin({detectionAt({0, 0, 0.0125})}, part);
  ASSERT_EQ(low.rejected.size(), 1u);
  EXPECT_EQ(low.rejected[0].rejection, GraspRejection::BinFloorCollision);
  EXPECT_NE(low.rejected[0].reason.find("2.5 mm"), std::string::npos) << low.rejected[0].reason;
}

TEST(GraspPlanner, FingersOnALinkageAreWhereTheyAreWhenOpenOnTheWayIn)
{
  // Opened to 50 mm the fingers reach 3 mm farther than when they hold at 30 mm: the flange is where the tip is right
  // for holding, so that they would come 3 mm nearer to the floor than the grasp itself.
  Gripper gripper = twoFingerGripper();
  gripper.tip_heights = {{0, 0.2}, {0.03, 0.2}, {0.05, 0.203}, {0.095, 0.203}};
  for (GripperBody& body : gripper.bodies)
    if (body.touches_part)
    {
      const double side = body.placements[1].offset.y() > 0 ? 1 : -1;
      body.placements = {{0, {0, 0, 0}, 0},
                         {0.03, {0, side * 0.015, 0}, 0},
                         {0.05, {0, side * 0.025, 0.003}, 0},
                         {0.095, {0, side * 0.0475, 0.003}, 0}};
    }
  const Bin bin = binBelowCamera();
  const GraspSelection selection =
      planWith({detectionAt({0, 0, 0.02})}, {partWith({graspFromAbove("top")})}, gripper, &bin, {});
  ASSERT_EQ(selection.grasps.size(), 1u);
  EXPECT_NEAR(selection.grasps[0].clearance.distance, 0.007, 1e-9);
}

TEST(GraspPlanner, TheWayInIsCheckedAndNotOnlyItsEnds)
{
  // Tilted by 60 degrees and from far away the gripper would come in through the wall: the pre-grasp is free outside of
  // the bin and the grasp is free inside of it.
  Bin bin = binBelowCamera();
  bin.inner_size.z() = 0.3;
  Gripper gripper = twoFingerGripper();
  gripper.bodies = {boxBody("needle", {0, 0, -0.025}, {0.002, 0.002, 0.02}, 0)};
  PartDefinition part = partWith({graspFromAbove("side")});
  part.grasps[0].approach = 0.3;
  GraspParameters parameters;
  parameters.max_tilt = 80 * DEGREE;
  const Detection detection =
      detectionAt({0, 0.1, 0.05}, Eigen::Quaterniond(AngleAxisd(-60 * DEGREE, Vector3d::UnitX())));
  const GraspSelection selection = planWith({detection}, {part}, gripper, &bin, parameters);
  ASSERT_EQ(selection.rejected.size(), 1u);
  const Vector3d start = bin.T_camera_bin.inverse() * selection.rejected[0].tip.pre_grasp.translation();
  EXPECT_GT(start.y(), 0.15 + bin.wall_thickness + 0.02);  // beyond the wall
  EXPECT_EQ(selection.rejected[0].rejection, GraspRejection::BinWallCollision);

  // Over a low wall the same way is free.
  bin.inner_size.z() = 0.06;
  EXPECT_EQ(planWith({detection}, {part}, gripper, &bin, parameters).grasps.size(), 1u);
}

TEST(GraspPlanner, AnOpenTurnIsRefusedUnlessTheCallerAcceptsIt)
{
  Detection open = detectionAt({-0.05, 0, 0.05});
  open.undetermined_turn = UndeterminedTurn{{Vector3d::UnitZ(), Vector3d::Zero()}, {}, 0.002};
  const std::vector<Detection> detections = {open, detectionAt({0.05, 0, 0.05})};
  PartDefinition part = partWith({graspFromAbove("top")});
  part.grasps[0].tilt_tolerance = 20 * DEGREE;  // nor is a turned copy offered in its place
  part.symmetry.discrete.emplace_back(AngleAxisd(M_PI, Vector3d::UnitZ()));
  const GraspSelection careful = selectInBin(detections, part);
  ASSERT_EQ(careful.rejected.size(), 1u) << "once for all its symmetric copies";
  EXPECT_EQ(careful.rejected[0].rejection, GraspRejection::UndeterminedTurn);
  EXPECT_EQ(careful.rejected[0].detection_index, 0u);
  EXPECT_NE(careful.rejected[0].reason.find("its turn about the axis z"), std::string::npos);
  for (const Grasp& grasp : careful.grasps)
    EXPECT_TRUE(grasp.detection_index == 1 && !grasp.undetermined_turn);

  const Bin bin = binBelowCamera();
  GraspPlanner::Request accepting;
  accepting.accept_undetermined_turn = true;
  const GraspSelection all = planWith(detections, {part}, twoFingerGripper(), &bin, {}, accepting);
  EXPECT_TRUE(all.rejected.empty());
  ASSERT_EQ(all.grasps.size(), 4u);
  for (const Grasp& grasp : all.grasps)
    EXPECT_EQ(grasp.undetermined_turn, grasp.detection_index == 0);
}

TEST(GraspPlanner, AnOpeningBeyondTheGripperIsRefused)
{
  PartDefinition part = partWith({graspFromAbove("fits"), graspFromAbove("too_wide")});
  part.grasps[0].opening = 0.095;
  part.grasps[1].opening = 0.096;
  part.symmetry.discrete.emplace_back(AngleAxisd(M_PI, Vector3d::UnitZ()));
  const GraspSelection selection = selectInBin({detectionAt({0, 0, 0.08})}, part);
  EXPECT_EQ(selection.grasps.size(), 2u);
  ASSERT_EQ(selection.rejected.size(), 1u);  // once, although the part has two symmetric copies
  EXPECT_EQ(selection.rejected[0].rejection, GraspRejection::OpeningTooSmall);
  EXPECT_NE(selection.rejected[0].reason.find("96.0 mm"), std::string::npos) << selection.rejected[0].reason;
}

TEST(GraspPlanner, ALowOrUnknownMatchingRateIsRefused)
{
  std::vector<Detection> detections;
  for (const double x : {-0.08, 0.0, 0.08})
    detections.push_back(detectionAt({x, 0, 0.06}));
  detections[0].matching_rate = 0.85;
  detections[1].matching_rate = 0.849;
  detections[2].matching_rate = std::numeric_limits<double>::quiet_NaN();
  const GraspSelection selection = selectInBin(detections, partWith({graspFromAbove("top")}));
  ASSERT_EQ(selection.grasps.size(), 1u);
  EXPECT_EQ(selection.grasps[0].detection_index, 0u);
  ASSERT_EQ(selection.rejected.size(), 2u);
  for (const Grasp& grasp : selection.rejected)
    EXPECT_EQ(grasp.rejection, GraspRejection::MatchingRateTooLow);
  EXPECT_NE(selection.rejected[0].reason.find("84.9 %"), std::string::npos) << selection.rejected[0].reason;
}

TEST(GraspPlanner, WithoutABinTiltAndRetreatFollowTheView)
{
  GraspParameters parameters;
  parameters.max_tilt = 20 * DEGREE;
  const Detection straight = detectionAt({0.3, 0, 0.05});  // where a wall would be
  const Detection tilted = detectionAt({0, 0, 0.05}, Eigen::Quaterniond(AngleAxisd(25 * DEGREE, Vector3d::UnitY())));
  const GraspSelection selection =
      planWith({straight, tilted}, {partWith({graspFromAbove("top")})}, twoFingerGripper(), nullptr, parameters);
  ASSERT_EQ(selection.grasps.size(), 1u);
  EXPECT_TRUE(std::isinf(selection.grasps[0].clearance.distance));
  EXPECT_NEAR(selection.grasps[0].tip.grasp.translation().z() - selection.grasps[0].tip.retreat.translation().z(), 0.1,
              1e-9);
  ASSERT_EQ(selection.rejected.size(), 1u);
  EXPECT_EQ(selection.rejected[0].rejection, GraspRejection::TiltTooLarge);
}

TEST(GraspPlanner, BetterGraspsComeFirst)
{
  const auto first = [](std::vector<Detection> detections, const PartDefinition& part) {
    const GraspSelection selection = selectInBin(detections, part);
    EXPECT_EQ(selection.grasps.size(), detections.size() * part.grasps.size());
    EXPECT_GT(selection.grasps[0].quality, selection.grasps[1].quality);
    return selection.grasps[0];
  };
  const PartDefinition one = partWith({graspFromAbove("top")});
  Detection better = detectionAt({0.05, 0, 0.06});
  better.score = 0.95;
  EXPECT_EQ(first({detectionAt({-0.02, 0, 0.06}), better}, one).detection_index, 1u);                    // score
  EXPECT_EQ(first({detectionAt({0, 0, 0.06}), detectionAt({0, 0.08, 0.10})}, one).detection_index, 1u);  // height
  EXPECT_EQ(first({detectionAt({-0.05, 0, 0.1}, Eigen::Quaterniond(AngleAxisd(0.4, Vector3d::UnitX()))),
                   detectionAt({0.05, 0, 0.1})},
                  one)
                .detection_index,
            1u);                                                                                        // tilt
  EXPECT_EQ(first({detectionAt({0, 0.115, 0.1}), detectionAt({0, 0, 0.1})}, one).detection_index, 1u);  // clearance
  PartDefinition two = partWith({graspFromAbove("spare"), graspFromAbove("preferred")});
  two.grasps[1].T_object_tip = two.grasps[1].T_object_tip * AngleAxisd(M_PI, Vector3d::UnitZ());  // the fingers swapped
  two.grasps[1].priority = 5;
  EXPECT_EQ(first({detectionAt({0, 0, 0.06})}, two).grasp_id, "preferred");  // priority
}

TEST(GraspPlanner, EqualGraspsKeepTheStatedOrder)
{
  // Turns about the approach leave everything that counts as it is. The axis lies askew in the part frame.
  const Eigen::Quaterniond askew(AngleAxisd(0.6, Vector3d(1, 2, 3).normalized()));
  PartDefinition part = partWith({graspFromAbove("a"), graspFromAbove("b")});
  for (GraspDefinition& grasp : part.grasps)
    grasp.T_object_tip = Pose(askew) * grasp.T_object_tip;
  part.grasps[1].T_object_tip = part.grasps[1].T_object_tip * AngleAxisd(M_PI / 2, Vector3d::UnitZ());
  part.symmetry.discrete.emplace_back(AngleAxisd(M_PI, askew * Vector3d::UnitZ()));
  // Many odd attitudes: the copies' tilts and heights differ by rounding, which must not decide.
  for (int attitude = 0; attitude < 50; ++attitude)
  {
    const Vector3d axis = Vector3d(0.3, -0.7, 0.011 * attitude).normalized();
    const Detection detection =
        detectionAt({0.013, 0.027, 0.08}, AngleAxisd(0.3 + 0.003 * attitude, axis) * askew.conjugate());
    Detection other = detection;
    other.T_camera_object.pretranslate(Vector3d(0.08, 0, 0));
    const GraspSelection selection = selectInBin({detection, other}, part);
    ASSERT_EQ(selection.grasps.size(), 8u);
    for (std::size_t i = 0; i < 8; ++i)
    {
      EXPECT_EQ(selection.grasps[i].detection_index, i / 4);
      EXPECT_EQ(selection.grasps[i].grasp_id, i / 2 % 2 ? "b" : "a");
      EXPECT_EQ(selection.grasps[i].symmetry_variant, static_cast<int>(i % 2));
    }
  }
}

TEST(GraspPlanner, OnlySoManyAreReturned)
{
  GraspParameters parameters;
  parameters.max_grasps = 3;
  std::vector<Detection> detections;
  for (const double x : {-0.12, -0.06, 0.0, 0.06, 0.12})
    detections.push_back(detectionAt({x, 0, 0.06}));
  EXPECT_EQ(selectInBin(detections, partWith({graspFromAbove("top")}), parameters).grasps.size(), 3u);
}

TEST(GraspPlanner, NothingKnownNothingOffered)
{
  EXPECT_TRUE(selectInBin({}, partWith({graspFromAbove("top")})).grasps.empty());
  EXPECT_TRUE(selectInBin({detectionAt({0, 0, 0.06})}, partWith({})).grasps.empty());
  Detection stranger = detectionAt({0, 0, 0.06});
  stranger.part = "stranger";
  const GraspSelection selection = selectInBin({stranger}, partWith({graspFromAbove("top")}));
  EXPECT_TRUE(selection.grasps.empty());
  EXPECT_TRUE(selection.rejected.empty());
}

TEST(GraspPlanner, AGripperWithoutBodiesCannotBeChecked)
{
  Gripper gripper = twoFingerGripper();
  gripper.bodies.clear();
  const Bin bin = binBelowCamera();
  const std::vector<Detection> detections = {detectionAt({0, 0, 0.06})};
  const std::vector<PartDefinition> parts = {partWith({graspFromAbove("top")})};
  EXPECT_THROW(planWith(detections, parts, gripper, &bin, {}), ParameterError);
}

TEST(GraspPlanner, ANeighbourInTheWayOfAFingerIsNamed)
{
  // The finger beside the part is 25 to 31 mm from its middle along y and reaches 10 mm below it.
  const PartDefinition part = partWith({graspFromAbove("top")});
  const Detection target = detectionAt({0, 0, 0.06});
  EXPECT_EQ(selectInBin({target, detectionAt({0, 0.031 + 0.014 + 0.002, 0.06})}, part).rejected.size(), 0u);
  const GraspSelection blocked = selectInBin({target, detectionAt({0, 0.031 + 0.014 - 0.003, 0.06})}, part);
  ASSERT_EQ(blocked.rejected.size(), 2u);  // each stands in the way of the other
  EXPECT_EQ(blocked.rejected[0].rejection, GraspRejection::PartCollision);
  EXPECT_EQ(blocked.rejected[0].clearance.part, 1);
  EXPECT_NEAR(blocked.rejected[0].clearance.distance, -0.003, 0.0005);
  EXPECT_NE(blocked.rejected[0].reason.find("finger"), std::string::npos) << blocked.rejected[0].reason;
  EXPECT_NE(blocked.rejected[0].reason.find("part 1"), std::string::npos) << blocked.rejected[0].reason;

  GraspPlanner::Request blindly;
  blindly.check_collision = false;
  const Bin bin = binBelowCamera();
  const GraspSelection all =
      planWith({target, detectionAt({0, 0.042, 0.06})}, {part}, twoFingerGripper(), &bin, {}, blindly);
  ASSERT_EQ(all.grasps.size(), 2u);
  EXPECT_FALSE(all.grasps[0].collision_checked);
}

TEST(GraspPlanner, ALowerPartUnderAnotherIsNotPulledOut)
{
  // The upper block lies across one end of the lower one; the gripper itself would pass beside it.
  PartDefinition part = partWith({graspFromAbove("top")});
  const GraspSelection selection = selectInBin({detectionAt({0, 0, 0.03}), detectionAt({0.018, 0, 0.0505})}, part);
  const auto lower = std::find_if(selection.rejected.begin(), selection.rejected.end(),
                                  [](const Grasp& g) { return g.detection_index == 0; });
  ASSERT_NE(lower, selection.rejected.end());
  EXPECT_EQ(lower->rejection, GraspRejection::HeldPartCollision) << lower->reason;
  // How much deeper than is allowed is not looked for.
  EXPECT_NE(lower->reason.find("more than 0.5 mm deeper into the part 1"), std::string::npos) << lower->reason;
}

/// Of the first detection.
std::vector<Grasp> ofTheFirst(const std::vector<Grasp>& grasps)
{
  std::vector<Grasp> of_first;
  std::copy_if(grasps.begin(), grasps.end(), std::back_inserter(of_first),
               [](const Grasp& grasp) { return grasp.detection_index == 0; });
  return of_first;
}

TEST(GraspPlanner, APreGraspWithinTheBinIsComeToFromAbove)
{
  GraspDefinition definition = graspFromAbove("top");
  definition.approach = 0.02;  // from there on, the tops of the fingers stay 35 mm below the rim
  Gripper fingers = twoFingerGripper();
  fingers.bodies.erase(fingers.bodies.begin());
  const Bin bin = binBelowCamera();
  // Between the fingers and the rim lies a neighbour: over a finger's edge, or 5 mm beside it.
  const auto planBelow = [&](double y) {
    return planWith({detectionAt({0, 0, 0.025}), detectionAt({0, y, 0.13})}, {partWith({definition})}, fingers, &bin,
                    {});
  };
  const GraspSelection below = planBelow(0.044);
  EXPECT_TRUE(ofTheFirst(below.grasps).empty());
  const std::vector<Grasp> rejected = ofTheFirst(below.rejected);
  ASSERT_EQ(rejected.size(), 1u);
  EXPECT_EQ(rejected[0].rejection, GraspRejection::PartCollision) << rejected[0].reason;
  EXPECT_NE(rejected[0].reason.find("On the way down to the pre-grasp the finger - would reach 1.0 mm into"),
            std::string::npos)
      << rejected[0].reason;

  EXPECT_EQ(ofTheFirst(planBelow(0.050).grasps).size(), 1u);
}

TEST(GraspPlanner, ARetreatWithinTheBinGoesOnUntilThePartIsOut)
{
  GraspDefinition definition = graspFromAbove("top");
  definition.retreat = 0.03;  // ends 50 mm below what lies over it
  const std::vector<Grasp> rejected = ofTheFirst(
      selectInBin({detectionAt({0, 0, 0.025}), detectionAt({0, 0, 0.125})}, partWith({definition})).rejected);
  ASSERT_EQ(rejected.size(), 1u);
  EXPECT_EQ(rejected[0].rejection, GraspRejection::HeldPartCollision) << rejected[0].reason;
}

TEST(GraspPlanner, OfTheCopiesThatAreTooSteepTheLeastSteepIsListed)
{
  PartDefinition part = partWith({graspFromAbove("side")});
  part.grasps[0].T_object_tip = AngleAxisd(100 * DEGREE, Vector3d::UnitX()) * part.grasps[0].T_object_tip;
  part.symmetry.discrete.emplace_back(AngleAxisd(M_PI, Vector3d::UnitX()));  // comes at 80 degrees
  const GraspSelection selection = selectInBin({detectionAt({0, 0, 0.06})}, part);
  EXPECT_TRUE(selection.grasps.empty());
  ASSERT_EQ(selection.rejected.size(), 1u);
  EXPECT_EQ(selection.rejected[0].rejection, GraspRejection::TiltTooLarge);
  EXPECT_NEAR(selection.rejected[0].tilt, 80 * DEGREE, 1e-9);
  EXPECT_EQ(selection.rejected[0].symmetry_variant, 1);
}

TEST(GraspPlanner, AnAvoidedPlaceIsSkippedWithItsReason)
{
  const std::vector<Detection> detections = {detectionAt({-0.08, 0, 0.06}), detectionAt({0.08, 0, 0.06})};
  GraspPlanner::Request request;
  request.avoid = [](std::size_t detection) {
    return detection == 0 ? std::string("It was missed 3 s ago.") : std::string();
  };
  const Bin bin = binBelowCamera();
  const GraspSelection selection =
      planWith(detections, {partWith({graspFromAbove("top")})}, twoFingerGripper(), &bin, {}, request);
  ASSERT_EQ(selection.grasps.size(), 1u);
  EXPECT_EQ(selection.grasps[0].detection_index, 1u);
  ASSERT_EQ(selection.rejected.size(), 1u);
  EXPECT_EQ(selection.rejected[0].rejection, GraspRejection::Avoided);
  EXPECT_EQ(selection.rejected[0].reason, "It was missed 3 s ago.");
}

TEST(GraspPlanner, ToleranceIsUsedOnlyForPartsThatHaveNothingElse)
{
  // Across the wall the fingers do not fit; spun by a quarter they do.
  PartDefinition part = partWith({graspFromAbove("top")});
  part.grasps[0].spin_tolerance = M_PI / 2;
  const Detection at_wall = detectionAt({0, 0.13, 0.07});
  const GraspSelection alone = selectInBin({at_wall}, part);
  ASSERT_FALSE(alone.grasps.empty());
  for (const Grasp& grasp : alone.grasps)
  {
    EXPECT_GT(std::abs(grasp.spun), 0.5);
    EXPECT_TRUE((grasp.tip.grasp * grasp.T_tip_object).isApprox(at_wall.T_camera_object, 1e-9));
  }
  const std::vector<Detection> with_another = {at_wall, detectionAt({0, 0, 0.07})};
  const GraspSelection two = selectInBin(with_another, part);
  EXPECT_EQ(std::count_if(two.grasps.begin(), two.grasps.end(), [](const Grasp& g) { return g.detection_index == 1; }),
            1)
      << "as written in the middle of the bin, and not turned";
  EXPECT_GT(two.grasps.size(), 1u) << "the one at the wall too";
  for (const Grasp& grasp : two.grasps)
    EXPECT_EQ(std::abs(grasp.spun) > 0.5, grasp.detection_index == 0);

  GraspParameters parameters;
  parameters.max_grasps = 1;
  const GraspSelection one = selectInBin(with_another, part, parameters);
  ASSERT_EQ(one.grasps.size(), 1u);
  EXPECT_EQ(one.grasps[0].detection_index, 1u) << "what is written comes first";
  EXPECT_EQ(one.grasps[0].spun, 0);
}

TEST(GraspPlanner, AGripperOfAnotherKindOrWidthIsRefused)
{
  PartDefinition part = partWith({graspFromAbove("fingers"), graspFromAbove("suction")});
  part.grasps[1].width = part.grasps[1].opening = 0;
  Gripper gripper = twoFingerGripper();
  gripper.min_opening = 0.035;
  const Bin bin = binBelowCamera();
  const GraspSelection selection = planWith({detectionAt({0, 0, 0.06})}, {part}, gripper, &bin, {});
  EXPECT_TRUE(selection.grasps.empty());
  ASSERT_EQ(selection.rejected.size(), 2u);
  EXPECT_EQ(selection.rejected[0].rejection, GraspRejection::ClosingTooSmall);
  EXPECT_NE(selection.rejected[0].reason.find("35.0 mm"), std::string::npos) << selection.rejected[0].reason;
  EXPECT_EQ(selection.rejected[1].rejection, GraspRejection::OtherGripper);
}

/// The camera 0.9 m above a bin that stands 0.5 m in front of the base, on its level; frame `base`.
Pose cameraInBase()
{
  Pose T_bin_base = Pose::Identity();
  T_bin_base.translation() = Vector3d(0, 0.5, 0);  // towards +y of the bin
  return T_bin_base.inverse() * binBelowCamera().T_camera_bin.inverse();
}

TEST(GraspPlanner, TheArmTakesTheWholeWayInOneConfiguration)
{
  const Robot robot = loadRobot(BIN_PICKING_SOURCE_DIR "/config/robots/ur5e.yaml");
  const Bin bin = binBelowCamera();
  DetectionResult result;
  result.detections = {detectionAt({0.05, 0, 0.06})};
  const std::vector<std::shared_ptr<const TrainedModel>> models = {blockModel()};
  const GraspPlanner planner({{partWith({graspFromAbove("top")})}, twoFingerGripper(), robot, GraspParameters(), 1});
  EXPECT_THROW(planner.plan({result, models, &bin, std::nullopt, true}, {}), ParameterError) << "where is the robot?";

  const GraspSelection selection = planner.plan({result, models, &bin, cameraInBase(), true}, {});
  ASSERT_EQ(selection.grasps.size(), 1u) << selection.rejected.at(0).reason;
  const Grasp& grasp = selection.grasps[0];
  EXPECT_TRUE(grasp.reach_checked);
  ASSERT_EQ(grasp.joints.size(), 3u);
  const Kinematics kinematics(robot);
  EXPECT_TRUE(kinematics.forward(grasp.joints[0]).isApprox(cameraInBase() * grasp.tool0.pre_grasp, 1e-8));
  EXPECT_TRUE(kinematics.forward(grasp.joints[1]).isApprox(cameraInBase() * grasp.tool0.grasp, 1e-8));
  EXPECT_TRUE(kinematics.forward(grasp.joints[2]).isApprox(cameraInBase() * grasp.tool0.retreat, 1e-8));
  // The tip of the gripper is where the grasp is.
  const Pose T_base_tip = kinematics.forward(grasp.joints[1]) * twoFingerGripper().T_tool0_tip(grasp.width);
  EXPECT_TRUE(T_base_tip.isApprox(cameraInBase() * grasp.tip.grasp, 1e-8));

  // A metre farther away there is nothing that the arm could reach.
  const Pose far = Eigen::Translation3d(0, -1, 0) * cameraInBase();
  const GraspSelection none = planner.plan({result, models, &bin, far, true}, {});
  ASSERT_EQ(none.rejected.size(), 1u);
  EXPECT_EQ(none.rejected[0].rejection, GraspRejection::OutOfReach);
  EXPECT_NE(none.rejected[0].reason.find(" m"), std::string::npos) << none.rejected[0].reason;

  GraspPlanner::Request anywhere;
  anywhere.check_reach = false;
  EXPECT_EQ(planner.plan({result, models, &bin, far, true}, anywhere).grasps.size(), 1u);
}

TEST(GraspPlanner, ACloudThatIsMissingIsNotTakenForAFreeOne)
{
  const Bin bin = binBelowCamera();
  const std::vector<std::shared_ptr<const TrainedModel>> models = {blockModel()};
  const GraspPlanner planner({{partWith({graspFromAbove("top")})}, twoFingerGripper(), std::nullopt, {}, 1});
  const Vector3d place(0, 0, 0.03);
  DetectionResult result;
  result.detections = {detectionAt(place)};
  try
  {
    planner.plan({result, models, &bin, std::nullopt}, {});
    ADD_FAILURE() << "no error";
  }
  catch (const ParameterError& error)
  {
    const std::string message = error.what();
    EXPECT_NE(message.find("Detector::detect()"), std::string::npos) << message;
    EXPECT_NE(message.find("without_cloud"), std::string::npos) << message;
  }
  GraspPlanner::Request blindly;
  blindly.check_collision = false;
  EXPECT_EQ(planner.plan({result, models, &bin, std::nullopt}, blindly).grasps.size(), 1u);

  result.surroundings = pictureOf({place});
  const GraspSelection alone = planner.plan({result, models, &bin, std::nullopt}, {});
  ASSERT_EQ(alone.grasps.size(), 1u) << alone.rejected.at(0).reason;
  EXPECT_TRUE(alone.grasps[0].collision_checked);
  // The cloud has what nobody recognised: a block under one of the fingers.
  result.surroundings = pictureOf({place, {0, 0.03, 0.03}});
  const GraspSelection blocked = planner.plan({result, models, &bin, std::nullopt}, {});
  ASSERT_EQ(blocked.rejected.size(), 1u);
  EXPECT_EQ(blocked.rejected[0].rejection, GraspRejection::SceneCollision) << blocked.rejected[0].reason;
  EXPECT_EQ(planner.plan({result, models, &bin, std::nullopt, true}, {}).grasps.size(), 1u) << "knowingly";
}

TEST(GraspPlanner, APoseThatIsNotFiniteIsRefused)
{
  Detection detection = detectionAt({0, 0, 0.06});
  detection.T_camera_object.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(selectInBin({detection}, partWith({graspFromAbove("top")})), ParameterError);
}

TEST(GraspPlanner, ASuctionCupIsPressedOnThePartThatItTakes)
{
  const Gripper cup = loadGripper(BIN_PICKING_SOURCE_DIR "/config/grippers/suction_cup_20mm.yaml");
  GraspDefinition on_top = graspFromAbove("on_top");
  on_top.T_object_tip.pretranslate(Vector3d(0, 0, 0.010));
  on_top.width = on_top.opening = 0;
  const Bin bin = binBelowCamera();
  const std::vector<std::shared_ptr<const TrainedModel>> models = {blockModel()};
  const GraspPlanner planner({{partWith({on_top})}, cup, std::nullopt, {}, 1});
  const Vector3d place(0, 0, 0.03);
  DetectionResult result;
  result.detections = {detectionAt(place)};
  result.surroundings = pictureOf({place});
  const GraspSelection selection = planner.plan({result, models, &bin, std::nullopt}, {});
  ASSERT_EQ(selection.grasps.size(), 1u) << selection.rejected.at(0).reason;
  EXPECT_TRUE(selection.grasps[0].collision_checked);

  // Other parts it must not touch: one that is 5 mm higher, under the rim of the lip (11 mm from its middle),
  // and that the cloud does not show.
  const Vector3d beside(0.0205, 0, 0.035);
  result.detections = {detectionAt(place), detectionAt(beside)};
  const GraspSelection blocked = planner.plan({result, models, &bin, std::nullopt}, {});
  const auto lower = std::find_if(blocked.rejected.begin(), blocked.rejected.end(),
                                  [](const Grasp& g) { return g.detection_index == 0; });
  ASSERT_NE(lower, blocked.rejected.end());
  EXPECT_EQ(lower->rejection, GraspRejection::PartCollision) << lower->reason;
  EXPECT_EQ(lower->clearance.body, "cup");

  // And only the lip may touch it: with the tip 25 mm too deep the holder would go in.
  on_top.T_object_tip.pretranslate(Vector3d(0, 0, -0.025));
  result.detections = {detectionAt({0, 0, 0.06})};
  result.surroundings = pictureOf({{0, 0, 0.06}});
  const GraspSelection deep =
      GraspPlanner({{partWith({on_top})}, cup, std::nullopt, {}, 1}).plan({result, models, &bin, std::nullopt}, {});
  ASSERT_EQ(deep.rejected.size(), 1u);
  EXPECT_EQ(deep.rejected[0].rejection, GraspRejection::TargetCollision) << deep.rejected[0].reason;
  EXPECT_EQ(deep.rejected[0].clearance.body, "holder");
}

void expectSame(const Grasp& a, const Grasp& b)
{
  EXPECT_EQ(a.grasp_id, b.grasp_id);
  EXPECT_EQ(a.detection_index, b.detection_index);
  EXPECT_EQ(a.symmetry_variant, b.symmetry_variant);
  EXPECT_EQ(a.tilted, b.tilted);
  EXPECT_EQ(a.spun, b.spun);
  EXPECT_EQ(a.tool0.grasp.matrix(), b.tool0.grasp.matrix());
  EXPECT_EQ(a.tip.grasp.matrix(), b.tip.grasp.matrix());
  EXPECT_EQ(a.tip.retreat.matrix(), b.tip.retreat.matrix());
  EXPECT_EQ(a.quality, b.quality);
  EXPECT_EQ(a.clearance.distance, b.clearance.distance);
  EXPECT_EQ(a.rejection, b.rejection);
  EXPECT_EQ(a.reason, b.reason);
}

void expectSame(const GraspSelection& a, const GraspSelection& b)
{
  ASSERT_EQ(a.grasps.size(), b.grasps.size());
  ASSERT_EQ(a.rejected.size(), b.rejected.size());
  for (std::size_t i = 0; i < a.grasps.size(); ++i)
    expectSame(a.grasps[i], b.grasps[i]);
  for (std::size_t i = 0; i < a.rejected.size(); ++i)
    expectSame(a.rejected[i], b.rejected[i]);
}

/// Along two walls ten parts that can be taken with the fingers turned only: more than are tried at a time. In the
/// middle two that can be taken as written.
GraspSelection planAlongWalls(int threads, std::size_t most, int enough)
{
  std::vector<Vector3d> places = {{-0.06, 0.01, 0.06}, {0.06, -0.01, 0.05}};
  for (const double x : {-0.14, -0.07, 0.0, 0.07, 0.14})
    for (const double y : {-0.13, 0.13})
      places.emplace_back(x, y, 0.06 + 0.05 * std::abs(x));
  DetectionResult result;
  for (const Vector3d& place : places)
    result.detections.push_back(detectionAt(place));
  result.surroundings = pictureOf(places);
  PartDefinition part = partWith({graspFromAbove("a")});
  part.grasps[0].spin_tolerance = M_PI / 2;
  part.grasps[0].tilt_tolerance = 20 * DEGREE;
  part.symmetry.discrete.emplace_back(AngleAxisd(M_PI, Vector3d::UnitZ()));
  const std::vector<std::shared_ptr<const TrainedModel>> models = {blockModel()};
  const Bin bin = binBelowCamera();
  GraspPlanner::Request request;
  request.max_grasps = most;
  GraspParameters parameters;
  parameters.max_grasps = 100;
  parameters.enough_grasps = enough;
  return GraspPlanner({{part}, twoFingerGripper(), std::nullopt, parameters, threads})
      .plan({result, models, &bin, std::nullopt}, request);
}

long numTurned(const GraspSelection& selection)
{
  return std::count_if(selection.grasps.begin(), selection.grasps.end(), [](const Grasp& g) { return g.spun != 0; });
}

TEST(GraspPlanner, TheSameForAnyNumberOfThreads)
{
  const GraspSelection few = planAlongWalls(1, 6, 100);
  EXPECT_EQ(few.grasps.size(), 6u);
  const GraspSelection all = planAlongWalls(1, 100, 100);
  EXPECT_GT(numTurned(all), 8 * 2) << "of all ten, and some of each";
  for (const int threads : {2, 4})
  {
    expectSame(few, planAlongWalls(threads, 6, 100));
    expectSame(all, planAlongWalls(threads, 100, 100));
  }
}

TEST(GraspPlanner, TolerancesAreUsedWhileThereAreNotEnoughGrasps)
{
  const GraspSelection as_written = planAlongWalls(1, 100, 0);
  const auto num_written = static_cast<int>(as_written.grasps.size());
  EXPECT_GE(num_written, 2) << "in the middle";
  EXPECT_EQ(numTurned(as_written), 0);
  EXPECT_EQ(numTurned(planAlongWalls(1, 100, num_written)), 0) << "enough";
  const auto detectionsOf = [](const GraspSelection& selection) {
    std::set<std::size_t> detections;
    for (const Grasp& grasp : selection.grasps)
      detections.insert(grasp.detection_index);
    return detections.size();
  };
  EXPECT_EQ(detectionsOf(planAlongWalls(1, 100, num_written + 1)), 2u + 8u) << "one time eight of them";
  EXPECT_EQ(detectionsOf(planAlongWalls(1, 100, 100)), 12u);
}

TEST(GraspPlanner, WhatHoldsForAllCopiesAroundAnAxisIsToldOnce)
{
  GraspDefinition written = graspFromAbove("a");
  written.opening = 1;  // no gripper opens as far
  GraspDefinition copy = written;
  copy.id = "a@90";
  copy.copy_of = "a";
  copy.T_object_tip = AngleAxisd(M_PI / 2, Vector3d::UnitZ()) * written.T_object_tip;
  GraspDefinition other = written;
  other.id = "b";
  other.T_object_tip = AngleAxisd(M_PI / 4, Vector3d::UnitZ()) * written.T_object_tip;
  const GraspSelection selection = selectInBin({detectionAt({0, 0, 0.03})}, partWith({written, copy, other}));
  EXPECT_TRUE(selection.grasps.empty());
  ASSERT_EQ(selection.rejected.size(), 2u);
  EXPECT_EQ(selection.rejected[0].grasp_id, "a");
  EXPECT_EQ(selection.rejected[1].grasp_id, "b");
}

TEST(GraspParameters, DefaultsLieWithinTheirRanges)
{
  GraspParameters parameters;
  for (const ParameterEntry& entry : listParameters(visitor(parameters)))
    EXPECT_NO_THROW(setParameter(visitor(parameters), entry.path, entry.value)) << entry.path;
  EXPECT_THROW(setParameter(visitor(parameters), "max_tilt=200deg"), ParameterError);
  setParameter(visitor(parameters), "max_tilt=30deg");
  EXPECT_NEAR(parameters.max_tilt, 30 * DEGREE, 1e-9);
}
}  // namespace
}  // namespace bin_picking
