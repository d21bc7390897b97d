// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/obstacles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "../../src/core/grasping/body_sweep.hpp"
#include "../../src/core/grasping/column_spans.hpp"
#include "../../src/core/grasping/sweep_lanes.hpp"
#include "bin_picking_perception/common/error.hpp"
#include "core/bin_of_grasps.hpp"
#include "core/mesh_shapes.hpp"

namespace bin_picking
{
namespace
{
using Eigen::Translation3d;
using Eigen::Vector3d;
using test::BinOfGrasps;

constexpr double FLOOR = 0.8;    // metres in front of the camera
constexpr double PITCH = 0.002;  // metres between pixels on the floor
constexpr double FLAT = 1e-6;    // rounding of single precision at a metre
const Vector3d BLOCK(0.04, 0.03, 0.03);

/// A bin of 300 x 240 x 120 mm under the camera. Its x is the camera's, its y and z are opposite.
Bin binBelowCamera()
{
  Bin bin;
  bin.T_camera_bin = Translation3d(0, 0, FLOOR) * Eigen::AngleAxisd(M_PI, Vector3d::UnitX());
  bin.inner_size = {0.3, 0.24, 0.12};
  return bin;
}

Pose inCamera(const Vector3d& position_bin) { return binBelowCamera().T_camera_bin * Translation3d(position_bin); }

TrainedModel boxModel(const std::string& name, const Vector3d& size)
{
  TrainedModel model;
  model.name = name;
  model.mesh = test::box(static_cast<float>(size.x()), static_cast<float>(size.y()), static_cast<float>(size.z()));
  model.parameters.surface_spacing = 0.0015;
  model.surface = sampleSurface(model.mesh, model.parameters.surface_spacing, 1);
  model.field = DistanceField(sampleSurface(model.mesh, 0.0005, 2), 0.001, 0.006);
  return model;
}

const TrainedModel& block()
{
  static const TrainedModel model = boxModel("block", BLOCK);
  return model;
}

/// A solid along the bin's axes.
struct Solid
{
  Vector3d center_bin;
  Vector3d size;
};

Solid blockAt(const Vector3d& center_bin) { return {center_bin, BLOCK}; }

/// What a camera at the origin sees of solids on the bin's floor: the first of all crossings.
DepthGrid pictureOf(const std::vector<Solid>& solids)
{
  PinholeCamera camera;
  camera.fx = camera.fy = FLOOR / PITCH;
  camera.cx = 127.5;
  camera.cy = 103.5;
  DepthGrid grid = makeGrid(256, 208, camera);
  const Pose T_bin_camera = binBelowCamera().T_camera_bin.inverse();
  for (int v = 0; v < grid.height; ++v)
    for (int u = 0; u < grid.width; ++u)
    {
      const Vector3d ray = camera.backProject(u, v, 1);
      double depth = FLOOR;
      for (const Solid& solid : solids)
      {
        const Eigen::Array3d from = (T_bin_camera.translation() - solid.center_bin).array();
        const Eigen::Array3d way = (T_bin_camera.linear() * ray).array();
        const Eigen::Array3d a = (-solid.size.array() / 2 - from) / way;
        const Eigen::Array3d b = (solid.size.array() / 2 - from) / way;
        const double enters = a.min(b).maxCoeff();
        if (enters < a.max(b).minCoeff())
          depth = std::min(depth, enters);
      }
      const Eigen::Vector3f p = (depth * ray).cast<float>();
      const auto i = static_cast<std::size_t>(grid.index(u, v));
      grid.x[i] = p.x();
      grid.y[i] = p.y();
      grid.z[i] = p.z();
    }
  return grid;
}

GripperBody fingerOf(const std::string& name, int side)
{
  GripperBody finger;
  finger.name = name;
  finger.shape = makeBox({0, side * 0.005, 0.175}, {0.02, 0.01, 0.06});
  finger.placements = {{0, {0, 0, 0}, 0}, {0.1, {0, side * 0.05, 0}, 0}};
  finger.touches_part = true;
  return finger;
}

/// Two fingers of 20 x 10 mm that end 5 mm beyond the tip, and a palm 60 mm behind it.
Gripper twoFingers()
{
  Gripper gripper;
  gripper.name = "two fingers";
  gripper.max_opening = 0.1;
  gripper.tip_heights = {{0, 0.2}};
  GripperBody palm;
  palm.name = "palm";
  palm.shape = makeBox({0, 0, 0.1}, {0.06, 0.12, 0.08});
  gripper.bodies = {palm, fingerOf("finger +", 1), fingerOf("finger -", -1)};
  return gripper;
}

/// The flange when the tip is at a place in the bin, from above, fingers along y.
Pose toolAt(const Vector3d& tip_bin)
{
  return inCamera(tip_bin) * Eigen::AngleAxisd(M_PI, Vector3d::UnitX()) * Translation3d(0, 0, -0.2);
}

const Vector3d DOWN_CAMERA(0, 0, 1);

ToolMotion wayDown(const Vector3d& tip_bin, double opening)
{
  return {Translation3d(-0.08 * DOWN_CAMERA) * toolAt(tip_bin), 0.08 * DOWN_CAMERA, opening};
}

ToolMotion wayUp(const Vector3d& tip_bin, double width) { return {toolAt(tip_bin), -0.1 * DOWN_CAMERA, width}; }

/// Blocks in the bin, all detected; the first is the target, in the middle of the floor.
struct Scene
{
  std::vector<Solid> solids = {blockAt({0, 0, 0.015})};
  std::vector<PlacedPart> parts = {{&block(), inCamera({0, 0, 0.015})}};
  ObstacleParameters parameters;
  bool with_bin = true;

  Scene& add(const Solid& solid, bool detected)
  {
    solids.push_back(solid);
    if (detected)
      parts.push_back({&block(), inCamera(solid.center_bin)});
    return *this;
  }

  Obstacles obstacles(int threads = 1) const
  {
    const Bin bin = binBelowCamera();
    const DepthGrid picture = pictureOf(solids);
    return {&picture, with_bin ? &bin : nullptr, parts, parameters, Executor(threads)};
  }
};

const Vector3d GRASP(0, 0, 0.015);  // the middle of the target
constexpr double OPENING = 0.05;    // outer faces of the fingers at +-35 mm, inner ones 10 mm from the target
constexpr double WIDTH = 0.03;

TEST(Obstacles, ABlockThatLiesAloneIsTaken)
{
  const Obstacles obstacles = Scene().obstacles();
  const Clearance in = obstacles.approach(twoFingers(), wayDown(GRASP, OPENING), 0);
  EXPECT_TRUE(in.free()) << in.distance << " " << in.body << " " << in.obstacle;
  const Clearance closing = obstacles.closing(twoFingers(), toolAt(GRASP), OPENING, WIDTH, 0);
  EXPECT_TRUE(closing.free()) << closing.distance << " " << closing.body << " " << closing.obstacle;
  const Clearance out = obstacles.retreat(twoFingers(), wayUp(GRASP, WIDTH), 0);
  EXPECT_TRUE(out.free()) << out.distance << " " << out.body << " " << out.obstacle;
}

TEST(Obstacles, ANeighbourBesideAFingerIsAsFarAsItIs)
{
  for (const double gap : {0.0035, 0.002, 0.0002, -0.0005, -0.004})
  {
    // The neighbour's face looks at the finger's outer face across the gap.
    const Vector3d neighbour(0, 0.035 + gap + 0.015, 0.015);
    Scene scene;
    scene.parts.push_back({&block(), inCamera(neighbour)});  // known, while the cloud does not show it
    const Clearance clearance = scene.obstacles().approach(twoFingers(), wayDown(GRASP, OPENING), 0);
    EXPECT_NEAR(clearance.distance, gap, FLAT);
    EXPECT_EQ(clearance.kind, ObstacleKind::Part);
    EXPECT_EQ(clearance.part, 1);
    EXPECT_EQ(clearance.obstacle, "part 1 (block)");
    EXPECT_EQ(clearance.body.substr(0, 6), "finger");
    EXPECT_EQ(clearance.free(), gap >= scene.parameters.part_clearance);
    const Vector3d contact = binBelowCamera().T_camera_bin.inverse() * clearance.contact_camera;
    EXPECT_LE((contact - neighbour).cwiseAbs().cwiseProduct(BLOCK.cwiseInverse()).maxCoeff(), 0.5 + 1e-4);
  }
}

TEST(Obstacles, AMeasuredNeighbourThatNobodyRecognisedIsInTheWayToo)
{
  for (const double gap : {0.002, -0.001, -0.005})
  {
    Scene scene;
    scene.add(blockAt({0, 0.035 + gap + 0.015, 0.015}), false);
    const Clearance clearance = scene.obstacles().approach(twoFingers(), wayDown(GRASP, OPENING), 0);
    // The measured points end up to a pixel before the edge.
    EXPECT_GE(clearance.distance, gap - 1e-4);
    EXPECT_LE(clearance.distance, gap + PITCH);
    EXPECT_EQ(clearance.kind, ObstacleKind::Surface);
    EXPECT_EQ(clearance.obstacle, "measured surface");
    EXPECT_EQ(clearance.part, -1);
  }
}

TEST(Obstacles, OpenFingersThatComeDownOnTheTargetAreRefused)
{
  const Clearance clearance = Scene().obstacles().approach(twoFingers(), wayDown(GRASP, 0.026), 0);
  EXPECT_EQ(clearance.kind, ObstacleKind::Target);
  EXPECT_EQ(clearance.part, 0);
  EXPECT_NEAR(clearance.distance, -0.002, FLAT);  // 2 mm of each finger over the top
  EXPECT_FALSE(clearance.free());
}

TEST(Obstacles, ThePalmMustNotPressOnTheTarget)
{
  // The tip 70 mm below the top: the palm, 60 mm behind the tip, would go 10 mm into it.
  Scene scene;
  const TrainedModel tower = boxModel("tower", {0.04, 0.03, 0.1});
  scene.solids = {{{0, 0, 0.05}, {0.04, 0.03, 0.1}}};
  scene.parts = {{&tower, inCamera({0, 0, 0.05})}};
  const Clearance clearance = scene.obstacles().approach(twoFingers(), wayDown({0, 0, 0.03}, OPENING), 0);
  EXPECT_EQ(clearance.kind, ObstacleKind::Target);
  EXPECT_EQ(clearance.body, "palm");
  EXPECT_NEAR(clearance.distance, -0.01, FLAT);
}

TEST(Obstacles, ClosingFingersMeetWhatStandsBetweenThemAndTheTarget)
{
  // A post of 4 x 4 mm in the gap of 10 mm between target and open finger.
  const TrainedModel post = boxModel("post", {0.004, 0.004, 0.03});
  Scene scene;
  scene.solids.push_back({{0, 0.02, 0.015}, {0.004, 0.004, 0.03}});
  scene.parts.push_back({&post, inCamera({0, 0.02, 0.015})});
  const Obstacles obstacles = scene.obstacles();
  EXPECT_TRUE(obstacles.approach(twoFingers(), wayDown(GRASP, OPENING), 0).free());
  const Clearance closing = obstacles.closing(twoFingers(), toolAt(GRASP), OPENING, WIDTH, 0);
  EXPECT_FALSE(closing.free());
  EXPECT_EQ(closing.kind == ObstacleKind::Part ? closing.part : 1, 1);
  EXPECT_TRUE(closing.kind == ObstacleKind::Part || closing.kind == ObstacleKind::Surface);
  // Stopped before it, there is nothing.
  EXPECT_TRUE(obstacles.closing(twoFingers(), toolAt(GRASP), OPENING, 0.0465, 0).free());
}

TEST(Obstacles, WhatDoesNotGripMustNotTouchTheTargetWhileClosing)
{
  Gripper gripper = twoFingers();
  gripper.bodies[1].touches_part = gripper.bodies[2].touches_part = false;
  const Clearance closing = Scene().obstacles().closing(gripper, toolAt(GRASP), OPENING, 0.026, 0);
  EXPECT_EQ(closing.kind, ObstacleKind::Target);
  EXPECT_NEAR(closing.distance, -0.002, FLAT);
}

TEST(Obstacles, AHeldPartMustNotBeDrawnIntoAWall)
{
  // 5 mm from the wall at +x, and a way out that leans towards it by 30 mm on 100 mm: below the rim for 90 mm.
  const Vector3d place(0.15 - 0.005 - BLOCK.x() / 2, 0, 0.015);
  Scene scene;
  scene.solids = {blockAt(place)};
  scene.parts = {{&block(), inCamera(place)}};
  scene.parameters.bin_clearance = 0;
  const Obstacles obstacles = scene.obstacles();
  ToolMotion out = wayUp(place, WIDTH);
  Gripper needle = twoFingers();  // so that not the gripper itself meets the wall
  for (GripperBody& body : needle.bodies)
    body.shape = makeBox({-0.02, 0, 0.15}, {0.002, 0.002, 0.05});
  EXPECT_TRUE(obstacles.retreat(needle, out, 0).free());
  out.motion_camera += 0.03 * Vector3d::UnitX();
  const Clearance clearance = obstacles.retreat(needle, out, 0);
  EXPECT_FALSE(clearance.free());
  EXPECT_EQ(clearance.kind, ObstacleKind::BinWall);
  EXPECT_EQ(clearance.body, "held part");
  EXPECT_EQ(clearance.obstacle, "wall at +x");
  // As it rises, the lower edge of the block still is below the rim when its side has passed the wall's face.
  EXPECT_LT(clearance.distance, -0.004);
}

TEST(Obstacles, WhatLiesOnTheTargetIsNotLifted)
{
  for (const bool detected : {true, false})
  {
    Scene scene;
    scene.add(blockAt({0.03, 0, 0.045}), detected);  // half over it, on its top
    const Clearance out = scene.obstacles().retreat(twoFingers(), wayUp({-0.01, 0, 0.015}, WIDTH), 0);
    EXPECT_FALSE(out.free());
    EXPECT_EQ(out.body, "held part");
    EXPECT_EQ(out.kind, detected ? ObstacleKind::Part : ObstacleKind::Surface);
  }
}

TEST(Obstacles, APartThatComesOutHidesNoClearanceOfTheGripper)
{
  // It stands on the floor, against another: touching them says nothing of how safe the fingers are.
  Scene scene;
  scene.add(blockAt({BLOCK.x(), 0, 0.015}), true);
  const Obstacles obstacles = scene.obstacles();
  const Clearance out = obstacles.pulledOut(wayUp({0, 0, 0.015}, WIDTH).motion_camera, 0);
  EXPECT_TRUE(out.free());
  EXPECT_EQ(out.kind, ObstacleKind::None) << out.obstacle;
}

TEST(ColumnSpans, holdAllSurfaceThatIsAsNearAsAsked)
{
  const OrientedPoints surface = sampleSurface(block().mesh, 0.0015, 1);
  const SurfaceBlocks blocks(surface.points);
  const Eigen::Vector3f direction = Eigen::Vector3f(0.2f, -0.3f, 0.9f).normalized();
  const float most = 0.0135f;
  const ColumnSpans spans(blocks, direction, most);
  for (const float distance : {0.002f, 0.0055f, most})
  {
    const ColumnSpans wide = spans.within(distance);
    std::size_t held = 0;
    for (float x = -0.04f; x <= 0.04f; x += 0.0021f)
      for (float y = -0.04f; y <= 0.04f; y += 0.0021f)
      {
        const Eigen::Vector3f at(x, y, 0.01f);
        const ColumnSpans::Span span = wide.at(at);
        for (const Eigen::Vector3f& p : surface.points)
        {
          const float along = direction.dot(p);
          if ((p - at - (along - direction.dot(at)) * direction).norm() > distance)
            continue;
          ++held;
          ASSERT_LE(span.begin, along) << at.transpose() << ", within " << distance;
          ASSERT_GE(span.end, along) << at.transpose() << ", within " << distance;
        }
      }
    EXPECT_GT(held, 1000u);
    EXPECT_GT(wide.at({0.1f, 0.1f, 0}).begin, wide.at({0.1f, 0.1f, 0}).end) << "far beside it there is nothing";
  }
}

TEST(ColumnSpans, tellOfManyPointsWhatTheyTellOfEach)
{
  const SurfaceBlocks blocks(sampleSurface(block().mesh, 0.0015, 1).points);
  const Eigen::Vector3f direction = Eigen::Vector3f(0.2f, -0.3f, 0.9f).normalized();
  const float distance = 0.004f;
  const float length = 0.05f;
  const ColumnSpans spans = ColumnSpans(blocks, direction, distance).within(distance);
  const Eigen::Isometry3f T_object_camera = Eigen::Translation3f(0.01f, -0.02f, -0.8f) *
                                            Eigen::AngleAxisf(0.3f, Eigen::Vector3f(1, 2, -1).normalized()) *
                                            Eigen::Isometry3f::Identity();
  const ColumnSpans::View view = spans.seenFrom(T_object_camera);
  constexpr int PIXELS = bin_picking::BLOCK;
  constexpr float STEP = 1.0f / 1200;
  std::size_t met = 0;
  std::size_t passed = 0;
  std::size_t different = 0;
  for (int v = -150; v < 150; v += 3)
    for (int u = -400; u < 0; u += PIXELS)
    {
      const Eigen::Vector3f ray(static_cast<float>(u) * STEP, static_cast<float>(v) * STEP, 1);
      float depth[PIXELS];
      for (int k = 0; k < PIXELS; ++k)
        depth[k] = 0.7f + 0.0011f * static_cast<float>((u + 7 * v + 13 * k) & 127);
      const unsigned bits = spans.meetOnWay(view, ray, STEP, depth, distance, length);
      float x[PIXELS], y[PIXELS];
      for (int k = 0; k < PIXELS; ++k)
      {
        x[k] = depth[k] * (ray.x() + static_cast<float>(k) * STEP);
        y[k] = depth[k] * ray.y();
      }
      const unsigned same_points = spans.meetOnWay(view, x, y, depth, distance, length);
      for (int k = 0; k < PIXELS; ++k)
      {
        const Eigen::Vector3f point =
            T_object_camera *
            Eigen::Vector3f(depth[k] * (ray + static_cast<float>(k) * STEP * Eigen::Vector3f::UnitX()));
        const ColumnSpans::Span span = spans.at(point);
        const float along = direction.dot(point);
        const bool meets =
            std::max(0.0f, span.begin - distance - along) <= std::min(length, span.end + distance - along);
        met += meets;
        passed += !meets;
        different += (bits >> k & 1) != (meets ? 1u : 0u) || (same_points >> k & 1) != (meets ? 1u : 0u);
      }
    }
  EXPECT_GT(met, 300u);
  EXPECT_GT(passed, 300u);
  EXPECT_LE(different, met / 100) << "only where rounding moves a point into the next column";
}

TEST(Obstacles, WhatLiesOnAnyEdgeOfTheTargetHoldsIt)
{
  // Without a cloud, which would show it too.
  const Bin bin = binBelowCamera();
  const Vector3d up = wayUp(GRASP, WIDTH).motion_camera;
  const auto isFree = [&](const Vector3d& other) {
    const std::vector<PlacedPart> parts = {{&block(), inCamera({0, 0, 0.015})}, {&block(), inCamera(other)}};
    return Obstacles(nullptr, &bin, parts, {}, Executor(1)).pulledOut(up, 0).free();
  };
  for (const Vector3d& side : {Vector3d(BLOCK.x(), 0, 0), Vector3d(0, BLOCK.y(), 0)})
    for (const double sign : {-1.0, 1.0})
    {
      const Vector3d over_edge = sign * side;
      const Vector3d inward = -over_edge.normalized();
      EXPECT_FALSE(isFree(Vector3d(0, 0, 0.045) + over_edge + 0.001 * inward)) << over_edge.transpose();
      EXPECT_TRUE(isFree(Vector3d(0, 0, 0.045) + over_edge - 0.005 * inward)) << over_edge.transpose();
    }
}

TEST(Obstacles, ANeighbourThatTheTargetTouchesDoesNotHoldIt)
{
  Scene scene;
  scene.add(blockAt({0.0401, 0, 0.015}), true);
  const Clearance out = scene.obstacles().retreat(twoFingers(), wayUp({-0.005, 0, 0.015}, WIDTH), 0);
  EXPECT_TRUE(out.free()) << out.distance << " " << out.body << " " << out.obstacle;
  // Nor where the poses are off, so that they seem to overlap at rest.
  scene.parts[1].T_camera_object = inCamera({0.0395, 0, 0.015});
  const Clearance seeming = scene.obstacles().retreat(twoFingers(), wayUp({-0.005, 0, 0.015}, WIDTH), 0);
  EXPECT_TRUE(seeming.free()) << seeming.distance << " " << seeming.body << " " << seeming.obstacle;
}

/// A tower off the middle hides what is behind it, seen from the camera above the middle.
Scene towerWithShadow(const TrainedModel& tower)
{
  Scene scene;
  scene.solids = {{{0, 0.07, 0.045}, {0.04, 0.03, 0.09}}};
  scene.parts = {{&tower, inCamera({0, 0.07, 0.045})}};
  return scene;
}

TEST(Obstacles, WhatAPartHidesIsNotFree)
{
  // The top edge at y = 85 mm and 90 mm height throws a shadow of 85 * 90 / (800 - 90) = 10.8 mm on the floor.
  const TrainedModel tower = boxModel("tower", {0.04, 0.03, 0.09});
  Scene scene = towerWithShadow(tower);
  scene.parts.push_back({&block(), inCamera({0, -0.05, 0.015})});
  scene.solids.push_back(blockAt({0, -0.05, 0.015}));
  // A finger 1 mm behind the tower, down to 5 mm above the floor: in full in its shadow at its lower end.
  Gripper finger = twoFingers();
  finger.bodies = {finger.bodies[1]};
  finger.bodies[0].placements = {{}};
  finger.bodies[0].shape = makeBox({0, 0, 0.16}, {0.02, 0.006, 0.09});
  const ToolMotion way = wayDown({0, 0.085 + 0.0012 + 0.003, 0.01}, 0);
  scene.parameters.unseen_entry = 0.004;
  const Clearance other = scene.obstacles().approach(finger, way, 1);
  EXPECT_EQ(other.kind, ObstacleKind::Unknown);
  EXPECT_EQ(other.obstacle, "unseen space");
  EXPECT_FALSE(other.free());
  // Where the part to be taken hides it, fingers may enter as far as its own parameter says.
  scene.parameters.target_clearance = 0;
  scene.parameters.shadow_entry = 0.004;
  EXPECT_EQ(scene.obstacles().approach(finger, way, 0).kind, ObstacleKind::Unknown);
  scene.parameters.shadow_entry = 0.1;
  const Clearance own = scene.obstacles().approach(finger, way, 0);
  EXPECT_TRUE(own.free()) << own.distance << " " << own.obstacle;
  // And as far as the other parameter says everywhere.
  scene.parameters.unseen_entry = 0.1;
  EXPECT_NE(scene.obstacles().approach(finger, way, 1).kind, ObstacleKind::Unknown);
  // What was not recognised may have any far side.
  scene.parts.erase(scene.parts.begin());
  EXPECT_EQ(scene.obstacles().approach(finger, way, 0).kind, ObstacleKind::Unknown);
  scene.parameters.unknown_entry = 0.1;
  EXPECT_NE(scene.obstacles().approach(finger, way, 0).kind, ObstacleKind::Unknown);
}

/// Takes the measurements from a strip of the bin, |x| < half_x and from_y < y < to_y, metres.
void forget(DepthGrid& grid, double half_x, double from_y, double to_y)
{
  for (int v = 0; v < grid.height; ++v)
    for (int u = 0; u < grid.width; ++u)
    {
      const Vector3d p = binBelowCamera().T_camera_bin.inverse() * grid.point(grid.index(u, v)).cast<double>();
      if (std::abs(p.x()) < half_x && p.y() > from_y && p.y() < to_y)
        grid.invalidate(grid.index(u, v));
    }
}

TEST(Obstacles, PixelsWithoutMeasurementAreNeitherFreeNorSurface)
{
  // Between two walls of 60 mm height a trench of 40 mm whose bottom was not measured.
  const std::vector<Solid> walls = {{{0, 0.06, 0.03}, {0.2, 0.08, 0.06}}, {{0, -0.06, 0.03}, {0.2, 0.08, 0.06}}};
  DepthGrid seen = pictureOf(walls);
  DepthGrid gap = seen;
  forget(gap, 0.05, -0.0205, 0.0205);
  Gripper finger = twoFingers();
  finger.bodies = {finger.bodies[1]};
  finger.bodies[0].placements = {{}};
  finger.bodies[0].shape = makeBox({0, 0, 0.16}, {0.02, 0.01, 0.08});
  const Bin bin = binBelowCamera();
  const std::vector<PlacedPart> parts = {{&block(), inCamera({0.13, 0.1, 0.015})}};
  const Obstacles measured(&seen, &bin, parts, {}, Executor(1));
  EXPECT_TRUE(measured.approach(finger, wayDown({0, 0, 0.02}, 0), 0).free());
  const Obstacles bridged(&gap, &bin, parts, {}, Executor(1));
  const Clearance clearance = bridged.approach(finger, wayDown({0, 0, 0.02}, 0), 0);
  EXPECT_EQ(clearance.kind, ObstacleKind::Unknown);
  // The bridge leads from top to top, 60 mm high; the finger ends at 20 mm, and 2 mm are allowed behind what is no
  // part.
  EXPECT_NEAR(clearance.distance, -0.038, 1e-3);
  EXPECT_TRUE(bridged.approach(finger, wayDown({0, 0, 0.059}, 0), 0).free());
}

TEST(Obstacles, AGapBesideWhatIsNotKnownIsHiddenInFull)
{
  // A wall of 60 mm, and beside it 30 mm that were not measured: bridged down to the floor.
  const Vector3d place(0, 0.06, 0.03);
  const Vector3d size(0.2, 0.08, 0.06);
  DepthGrid gap = pictureOf({{place, size}});
  forget(gap, 0.05, -0.01, 0.0205);
  Gripper finger = twoFingers();
  finger.bodies = {finger.bodies[1]};
  finger.bodies[0].placements = {{}};
  finger.bodies[0].shape = makeBox({0, 0, 0.16}, {0.02, 0.01, 0.08});
  const ToolMotion way = wayDown({0, 0.005, 0.045}, 0);  // 10 mm from the wall, and above the bridge
  const Bin bin = binBelowCamera();
  std::vector<PlacedPart> parts = {{&block(), inCamera({0.13, -0.1, 0.015})}};
  const Clearance unknown = Obstacles(&gap, &bin, parts, {}, Executor(1)).approach(finger, way, 0);
  EXPECT_EQ(unknown.kind, ObstacleKind::Unknown);
  EXPECT_NEAR(unknown.distance, -0.013, 1e-3) << "15 mm below the wall's top, of which 2 mm are allowed";
  ObstacleParameters lenient;  // whichever of the limits is the smallest, each holds for its pixels
  lenient.unseen_entry = 0.004;
  lenient.shadow_entry = 0.003;
  lenient.unknown_entry = 0.006;
  const Clearance still = Obstacles(&gap, &bin, parts, lenient, Executor(1)).approach(finger, way, 0);
  EXPECT_NEAR(still.distance, -0.009, 1e-3);
  // Also in the middle of a wide gap, far from all that was measured.
  DepthGrid wide = pictureOf({{place, size}});
  forget(wide, 0.09, -0.08, 0.0205);
  const ToolMotion middle = wayDown({0, -0.03, 0.045}, 0);
  const Clearance amid = Obstacles(&wide, &bin, parts, {}, Executor(1)).approach(finger, middle, 0);
  EXPECT_EQ(amid.kind, ObstacleKind::Unknown);
  EXPECT_NEAR(amid.distance, -0.013, 1e-3);
  const TrainedModel wall = boxModel("wall", size);
  parts.push_back({&wall, inCamera(place)});
  const Clearance known = Obstacles(&gap, &bin, parts, {}, Executor(1)).approach(finger, way, 0);
  EXPECT_TRUE(known.free()) << known.obstacle << " " << known.distance;
}

TEST(Obstacles, BeyondThePictureOnlyTheInsideOfTheBinIsUnknown)
{
  // A picture of the bin's left half.
  DepthGrid whole = pictureOf({});
  DepthGrid half = makeGrid(128, whole.height, whole.camera);
  for (int v = 0; v < half.height; ++v)
    for (int u = 0; u < half.width; ++u)
    {
      const auto from = static_cast<std::size_t>(whole.index(u, v));
      const auto to = static_cast<std::size_t>(half.index(u, v));
      half.x[to] = whole.x[from];
      half.y[to] = whole.y[from];
      half.z[to] = whole.z[from];
    }
  const Bin bin = binBelowCamera();
  const std::vector<PlacedPart> parts = {{&block(), inCamera({-0.1, 0, 0.015})}};
  const Obstacles obstacles(&half, &bin, parts, {}, Executor(1));
  EXPECT_TRUE(obstacles.approach(twoFingers(), wayDown({-0.06, 0, 0.02}, 0.05), 0).free());
  const Clearance inside = obstacles.approach(twoFingers(), wayDown({0.06, 0, 0.02}, 0.05), 0);
  EXPECT_EQ(inside.kind, ObstacleKind::Unknown);
  EXPECT_TRUE(obstacles.approach(twoFingers(), wayDown({0.06, 0, 0.13}, 0.05), 0).free()) << "above the rim";
  // Without a bin nothing is said there.
  const Obstacles without(&half, nullptr, parts, {}, Executor(1));
  EXPECT_TRUE(without.approach(twoFingers(), wayDown({0.06, 0, 0.02}, 0.05), 0).free());
}

TEST(Obstacles, FloorWallAndRim)
{
  const Bin bin = binBelowCamera();
  const std::vector<PlacedPart> parts = {{&block(), inCamera({0.1, 0.05, 0.015})}};
  const Obstacles obstacles(nullptr, &bin, parts, {}, Executor(1));
  const Clearance floor = obstacles.approach(twoFingers(), wayDown({0, 0, 0.007}, OPENING), 0);
  EXPECT_EQ(floor.kind, ObstacleKind::BinFloor);
  EXPECT_EQ(floor.obstacle, "floor");
  EXPECT_NEAR(floor.distance, 0.002, 1e-6);
  EXPECT_NEAR(floor.required, 0.003, 1e-9);
  EXPECT_FALSE(floor.free());
  EXPECT_TRUE(obstacles.approach(twoFingers(), wayDown({0, 0, 0.009}, OPENING), 0).free());
  // The finger's outer face at 35 mm from the tip, the wall at 120 mm; the palm stays 10 mm over the rim.
  const double high = bin.inner_size.z() - 0.05;
  const Clearance wall = obstacles.approach(twoFingers(), wayDown({0, 0.12 - 0.035 - 0.001, high}, OPENING), 0);
  EXPECT_EQ(wall.kind, ObstacleKind::BinWall);
  EXPECT_EQ(wall.obstacle, "wall at +y");
  EXPECT_NEAR(wall.distance, 0.001, 1e-6);
  // The palm, 60 mm to either side and 60 mm above the tip, sits on the rim when the tip is deeper than 60 mm below it.
  const Clearance rim = obstacles.approach(twoFingers(), wayDown({0, 0.12 - 0.045, 0.05}, OPENING), 0);
  EXPECT_EQ(rim.kind, ObstacleKind::BinWall);
  EXPECT_EQ(rim.body, "palm");
  EXPECT_NEAR(rim.distance, -0.01, 1e-6);
}

TEST(Obstacles, ALargeClearanceOfTheBinIsKept)
{
  // The finger's outer face 30 mm from the wall: farther than the bin is looked at where less is required.
  const Bin bin = binBelowCamera();
  const std::vector<PlacedPart> parts = {{&block(), inCamera({0.1, 0.05, 0.015})}};
  const ToolMotion way = wayDown({0, 0.12 - 0.035 - 0.03, 0.09}, OPENING);
  ObstacleParameters parameters;
  parameters.bin_clearance = 0.05;
  const Clearance near = Obstacles(nullptr, &bin, parts, parameters, Executor(1)).approach(twoFingers(), way, 0);
  EXPECT_FALSE(near.free());
  EXPECT_EQ(near.obstacle, "wall at +y");
  EXPECT_NEAR(near.distance, 0.03, 1e-6);
  parameters.bin_clearance = 0.029;
  EXPECT_TRUE(Obstacles(nullptr, &bin, parts, parameters, Executor(1)).approach(twoFingers(), way, 0).free());
}

/// A picture in which nothing was measured, of a camera like that of the others.
DepthGrid blackPicture()
{
  const DepthGrid seen = pictureOf({});
  return makeGrid(seen.width, seen.height, seen.camera);
}

TEST(Obstacles, ACameraInTheBinHasNotSeenWhatIsBesideItsPicture)
{
  // The rim 100 mm behind the camera, and a picture of the left half.
  Bin deep = binBelowCamera();
  deep.inner_size.z() = 0.9;
  const DepthGrid whole = blackPicture();
  const DepthGrid half = makeGrid(128, whole.height, whole.camera);
  const std::vector<PlacedPart> parts = {{&block(), inCamera({-0.1, 0, 0.015})}};
  const Obstacles obstacles(&half, &deep, parts, {}, Executor(1));
  EXPECT_EQ(obstacles.approach(twoFingers(), wayDown({0.06, 0, 0.02}, 0.05), 0).kind, ObstacleKind::Unknown);
  // Farther out than the corners of the floor, which alone have a place in the picture.
  EXPECT_EQ(obstacles.approach(twoFingers(), wayDown({0.1, 0, 0.55}, 0.05), 0).kind, ObstacleKind::Unknown);
}

TEST(Obstacles, WhatTheNearWallHidesIsNotFree)
{
  // A camera 1 m before the wall at -y and half a metre above the rim does not see the floor behind that wall.
  Pose T_bin_camera = Pose::Identity();
  T_bin_camera.translation() = Vector3d(0, -1, 0.62);
  const Vector3d forward = -T_bin_camera.translation().normalized();
  T_bin_camera.linear() << Vector3d::UnitX(), forward.cross(Vector3d::UnitX()), forward;
  Bin bin = binBelowCamera();
  bin.T_camera_bin = T_bin_camera.inverse();
  Gripper peg = twoFingers();
  peg.bodies = {peg.bodies[1]};
  peg.bodies[0].placements = {{}};
  peg.bodies[0].shape = makeBox({0, 0, 0.19}, {0.01, 0.01, 0.02});
  ToolMotion way;
  way.T_camera_tool0 = bin.T_camera_bin * Translation3d(0, -0.09, 0.01) * Eigen::AngleAxisd(M_PI, Vector3d::UnitX()) *
                       Translation3d(0, 0, -0.2);
  way.motion_camera = 0.002 * way.T_camera_tool0.linear().col(2);
  const DepthGrid black = blackPicture();
  const std::vector<PlacedPart> parts = {{&block(), bin.T_camera_bin * Translation3d(0.1, 0.1, 0.015)}};
  const Clearance clearance = Obstacles(&black, &bin, parts, {}, Executor(1)).approach(peg, way, 0);
  EXPECT_EQ(clearance.kind, ObstacleKind::Unknown) << clearance.distance << " " << clearance.obstacle;
  // The same peg in front of the wall is not in the bin.
  way.T_camera_tool0.pretranslate(bin.T_camera_bin.linear() * Vector3d(0, -0.06, 0));
  EXPECT_TRUE(Obstacles(&black, &bin, parts, {}, Executor(1)).approach(peg, way, 0).free());
}

TEST(Obstacles, WithoutBinAndCloudOnlyPartsAreKnown)
{
  Scene scene;
  scene.with_bin = false;
  scene.add(blockAt({0, 0.05, 0.015}), true);
  EXPECT_EQ(
      Obstacles(nullptr, nullptr, scene.parts, {}, Executor(1)).approach(twoFingers(), wayDown(GRASP, OPENING), 0).kind,
      ObstacleKind::Part);
  // The measured floor is in the way without a bin too.
  const Clearance floor = Scene().obstacles().approach(twoFingers(), wayDown({0, 0, -0.001}, OPENING), 0);
  EXPECT_FALSE(floor.free());
  Scene open;
  open.with_bin = false;
  const Clearance measured = open.obstacles().approach(twoFingers(), wayDown({0, 0, 0.003}, OPENING), 0);
  EXPECT_EQ(measured.kind, ObstacleKind::Surface);
  EXPECT_NEAR(measured.distance, -0.002, FLAT);
}

TEST(Obstacles, MisuseIsNamed)
{
  const Obstacles obstacles = Scene().obstacles();
  EXPECT_THROW(obstacles.approach(twoFingers(), wayDown(GRASP, OPENING), 1), ParameterError);
  EXPECT_THROW(obstacles.approach(twoFingers(), wayDown(GRASP, 0.2), 0), ParameterError);
  Gripper nothing = twoFingers();
  nothing.bodies.clear();
  EXPECT_THROW(obstacles.retreat(nothing, wayUp(GRASP, WIDTH), 0), ParameterError);
  EXPECT_THROW(Obstacles(nullptr, nullptr, {PlacedPart{}}, {}, Executor(1)), ParameterError);
  ObstacleParameters wrong;
  wrong.unseen_entry = -1;
  EXPECT_THROW(Obstacles(nullptr, nullptr, {}, wrong, Executor(1)), ParameterError);
}

TEST(Obstacles, WhatIsNotFiniteIsRefused)
{
  const Scene scene;
  const Obstacles obstacles = scene.obstacles();
  // The last is finite, but not in single precision.
  for (const double wrong : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300})
  {
    ToolMotion way = wayDown(GRASP, OPENING);
    way.T_camera_tool0.translation().y() = wrong;
    EXPECT_THROW(obstacles.approach(twoFingers(), way, 0), ParameterError);
    EXPECT_THROW(obstacles.closing(twoFingers(), way.T_camera_tool0, OPENING, WIDTH, 0), ParameterError);
    EXPECT_THROW(obstacles.leaving(shapeAt(twoFingers(), WIDTH), way, 0), ParameterError);
    way = wayDown(GRASP, OPENING);
    way.motion_camera.x() = wrong;
    EXPECT_THROW(obstacles.approach(twoFingers(), way, 0), ParameterError);
    EXPECT_THROW(obstacles.retreat(twoFingers(), way, 0), ParameterError);
    EXPECT_THROW(obstacles.pulledOut(way.motion_camera, 0), ParameterError);
    EXPECT_THROW(obstacles.approach(twoFingers(), wayDown(GRASP, wrong), 0), ParameterError);
    Gripper rigid = twoFingers();
    for (GripperBody& body : rigid.bodies)
      body.placements = {{}};
    EXPECT_THROW(obstacles.closing(rigid, toolAt(GRASP), OPENING, wrong, 0), ParameterError);
    EXPECT_THROW(obstacles.closing(rigid, toolAt(GRASP), wrong, WIDTH, 0), ParameterError);

    const auto make = [&](const Bin& bin, const Pose& T_camera_object) {
      Obstacles(nullptr, &bin, {{&block(), T_camera_object}}, {}, Executor(1));
    };
    const Bin bin = binBelowCamera();
    const Pose pose = inCamera(GRASP);
    EXPECT_NO_THROW(make(bin, pose));
    Pose wrong_pose = pose;
    wrong_pose.linear()(1, 2) = wrong;
    EXPECT_THROW(make(bin, wrong_pose), ParameterError);
    Bin wrong_bin = bin;
    wrong_bin.T_camera_bin.translation().z() = wrong;
    EXPECT_THROW(make(wrong_bin, pose), ParameterError);
    wrong_bin = bin;
    wrong_bin.inner_size.y() = wrong;
    EXPECT_THROW(make(wrong_bin, pose), ParameterError);
    wrong_bin = bin;
    wrong_bin.wall_thickness = wrong;
    EXPECT_THROW(make(wrong_bin, pose), ParameterError);
  }
}

TEST(Obstacles, WhatIsNoNumberIsWorseThanAnyDistance)
{
  Encounter unknown;
  unknown.distance = std::numeric_limits<float>::quiet_NaN();
  Encounter deep;
  deep.distance = -1;
  Encounter worst;
  keepWorse(worst, unknown);
  EXPECT_TRUE(std::isnan(worst.distance));
  keepWorse(worst, deep);
  EXPECT_TRUE(std::isnan(worst.distance));
  EXPECT_FALSE(worst.free());
  keepWorse(deep, unknown);
  EXPECT_TRUE(std::isnan(deep.distance));
}

BinOfGrasps::Kind demoKind(const std::string& name)
{
  BinOfGrasps::Kind kind;
  kind.definition = loadPart(std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/" + name);
  TrainedModel model;
  model.name = name;
  model.mesh = loadMesh(kind.definition.mesh_file, kind.definition.mesh_unit);
  model.parameters.leaf = 0.004;
  model.surface = sampleSurface(model.mesh, 0.002, 1);
  model.field = DistanceField(sampleSurface(model.mesh, 0.0007, 2), 0.0013, 0.006);
  model.symmetry = kind.definition.symmetry;
  kind.model = std::make_shared<const TrainedModel>(std::move(model));
  return kind;
}

/// How deep the gripper truly gets into parts on ways that are called free.
struct Tally
{
  /// \param depth metres; asked for where it counts only, since it takes long
  template <typename Depth>
  void add(const Clearance& clearance, const Depth& depth)
  {
    if (!clearance.free())
      return;
    ++called_free;
    deepest = std::max(deepest, depth());
  }

  int called_free = 0;
  double deepest = 0;  ///< metres
};

struct Tallies
{
  Tally in, closing, out;
};

TEST(ObstaclesAgainstTruth, NoGraspIsCalledFreeThatIsNot)
{
  // All that is not detected counts as well; poses are off by 0.3 mm and 0.2 degrees (standard deviations).
  const Gripper gripper = loadGripper(std::string(BIN_PICKING_SOURCE_DIR) + "/config/grippers/ag95.yaml");
  simulation::CellParameters cell;
  // Once with little room to spare, so that a wrong verdict is not hidden by it.
  ObstacleParameters tight;
  tight.surface_clearance = tight.part_clearance = 0.0005;
  tight.target_clearance = 0;
  Tallies with_little_room;
  Tallies by_default;
  int truly_free = 0;
  int both = 0;
  for (const std::uint32_t seed : {1u, 2u, 3u})
  {
    BinOfGrasps bin({demoKind("three_way_tube")}, {15}, seed, cell, {});
    ASSERT_GE(bin.placed.size(), 3u);
    const Obstacles one(&bin.measured, &bin.bin, bin.placed, tight, Executor(1));
    const Obstacles two(&bin.measured, &bin.bin, bin.placed, tight, Executor(2));
    const Obstacles usual(&bin.measured, &bin.bin, bin.placed, {}, Executor(1));
    for (int i = 0; i < 500; ++i)
    {
      const test::TriedGrasp grasp = bin.randomGrasp(gripper);
      const Clearance clearance = one.approach(gripper, grasp.approach, grasp.target);
      const Clearance again = two.approach(gripper, grasp.approach, grasp.target);
      EXPECT_EQ(clearance.distance, again.distance);
      EXPECT_EQ(clearance.obstacle, again.obstacle);
      const double depth = test::trueApproachDepth(bin, gripper, grasp);
      const bool is_bin = clearance.kind == ObstacleKind::BinWall || clearance.kind == ObstacleKind::BinFloor;
      if (clearance.free() || !is_bin)  // the truth leaves out the bin
      {
        truly_free += depth == 0;
        both += clearance.free() && depth == 0;
      }
      const ToolShape closing = closingShape(gripper, grasp.approach.opening, grasp.retreat.opening);
      const ToolShape closed = shapeAt(gripper, grasp.retreat.opening);
      for (const auto& [obstacles, tallies] : {std::pair(&one, &with_little_room), std::pair(&usual, &by_default)})
      {
        tallies->in.add(obstacles->approach(gripper, grasp.approach, grasp.target), [&] { return depth; });
        tallies->closing.add(obstacles->closing(closing, grasp.retreat.T_camera_tool0, grasp.target),
                             [&] { return test::trueClosingDepth(bin, gripper, grasp); });
        tallies->out.add(obstacles->leaving(closed, grasp.retreat, grasp.target),
                         [&] { return test::trueRetreatDepth(bin, gripper, grasp); });
      }
    }
  }
  for (const Tallies* tallies : {&with_little_room, &by_default})
    for (const Tally* tally : {&tallies->in, &tallies->closing, &tallies->out})
    {
      EXPECT_GT(tally->called_free, 50);
      EXPECT_LT(tally->deepest, 0.0005);
    }
  // Not by refusing everything.
  EXPECT_GT(both, 0.6 * truly_free);
}
}  // namespace
}  // namespace bin_picking
