// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/refinement/rivals.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bin_picking_perception/model/depth_renderer.hpp"
#include "bin_picking_perception/refinement/verification.hpp"

namespace bin_picking
{
namespace
{
constexpr double DEGREE = M_PI / 180;
constexpr double TOLERANCE = 0.0008;  // metres: what eight standard deviations of a good sensor are
constexpr double SURE = 10;           // VerificationParameters::min_turn_margin

PartDefinition definitionOf(const std::string& part)
{
  return loadPart(std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/" + part);
}

const TrainedModel& shaft()
{
  static const auto model = trainPart(definitionOf("stepped_shaft"), {}, Executor(2));
  return *model;
}

OrientedPoints sphere(double radius)
{
  OrientedPoints points;
  constexpr int COUNT = 40000;
  for (int i = 0; i < COUNT; ++i)  // a spiral from pole to pole spaces them evenly
  {
    const double z = 1 - (2 * i + 1.0) / COUNT;
    const double turn = i * 2.399963;
    const Eigen::Vector3d n(std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn), z);
    points.points.push_back((radius * n).cast<float>());
    points.normals.push_back(n.cast<float>());
  }
  return points;
}

TEST(DistanceField, MeasuresASphereInsideAndOutside)
{
  const double radius = 0.02;
  const double cell = 0.001;
  const double band = 0.005;
  const DistanceField field(sphere(radius), cell, band);
  for (const double r : {0.0155, 0.018, 0.0199, 0.02, 0.0203, 0.022, 0.0245})
    for (const Eigen::Vector3d& direction :
         {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(1, -2, 3), Eigen::Vector3d(-1, 1, 1)})
      EXPECT_NEAR(field.at((r * direction.normalized()).cast<float>()), r - radius, cell / 8) << r;
  EXPECT_FLOAT_EQ(field.at(Eigen::Vector3f(0.5f, 0, 0)), static_cast<float>(band));
  EXPECT_NEAR(std::abs(field.at(Eigen::Vector3f::Zero())), band, 1e-7);
}

TEST(NearSymmetry, AShaftIsNearlyABodyOfRevolutionAboutItsAxisAlone)
{
  std::size_t about_axis = 0;
  for (const NearSymmetry& near : shaft().near_symmetries)
  {
    EXPECT_GT(near.broken, 0.005) << "the keyway breaks every turn";
    about_axis += std::abs(near.axis.direction.z()) > 0.999 && near.broken < 0.1;
  }
  EXPECT_EQ(about_axis, 23u);  // steps of 15 degrees
  EXPECT_EQ(about_axis, shaft().near_symmetries.size());
}

TEST(NearSymmetry, DeclaredTurnsAreNoRivals)
{
  const auto bolt = trainPart(definitionOf("hex_bolt"), {}, Executor(2));
  bool has_half_step = false;
  for (const NearSymmetry& near : bolt->near_symmetries)
  {
    const Eigen::AngleAxisd turn(near.T_object_object.linear());
    if (std::abs(turn.axis().z()) < 0.999)
      continue;
    const double sixths = turn.angle() / (60 * DEGREE);
    EXPECT_GT(std::abs(sixths - std::round(sixths)), 0.1) << turn.angle() / DEGREE << " degrees";
    has_half_step = has_half_step || std::abs(turn.angle() - 30 * DEGREE) < 1e-6;
  }
  EXPECT_TRUE(has_half_step);
}

/// What a camera sees of the shaft that lies across its view, turned about its own axis; 0: the keyway faces the
/// camera.
struct ShaftView
{
  explicit ShaftView(double turn) : truth(poseAt(turn))
  {
    DepthRenderer renderer(480, 384, PinholeCamera{750, 750, 239.5, 191.5});
    renderer.draw(shaft().mesh, truth, 0);
    grid = renderer.grid();
    surroundings = grid;
    for (int i = 0; i < static_cast<int>(grid.size()); ++i)
      if (!grid.valid(i))  // a floor that is not a part
      {
        const Eigen::Vector3d p = grid.camera.backProject(i % grid.width, i / grid.width, 0.66);
        surroundings.x[static_cast<std::size_t>(i)] = static_cast<float>(p.x());
        surroundings.y[static_cast<std::size_t>(i)] = static_cast<float>(p.y());
        surroundings.z[static_cast<std::size_t>(i)] = static_cast<float>(p.z());
      }
  }

  static Pose poseAt(double turn)
  {
    Pose T = Pose::Identity();
    T.linear().col(0) = -Eigen::Vector3d::UnitZ();  // the keyway's side, towards the camera
    T.linear().col(2) = Eigen::Vector3d::UnitX();
    T.linear().col(1) = T.linear().col(2).cross(T.linear().col(0));
    T.translation() = Eigen::Vector3d(0, 0, 0.6) - T.linear() * shaft().center;
    return T * Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ());
  }

  RivalChoice choose(double given) const
  {
    return chooseAmongRivals(shaft(), poseAt(given), grid, surroundings, TOLERANCE, SURE);
  }

  Pose truth;
  DepthGrid grid;
  DepthGrid surroundings;
};

double turnBetween(const Pose& a, const Pose& b)
{
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

TEST(Rivals, AKeywayInViewTurnsTheShaftTheRightWay)
{
  const ShaftView view(20 * DEGREE);
  for (const double off : {95.0, -60.0, 172.0})
  {
    const RivalChoice choice = view.choose((20 + off) * DEGREE);
    EXPECT_TRUE(choice.turned);
    EXPECT_LT(turnBetween(choice.T_camera_object, view.truth), 5 * DEGREE) << "given " << off << " degrees off";
    EXPECT_GT(choice.margin, SURE);
  }
}

TEST(Rivals, ARightPoseIsKeptBitForBit)
{
  const ShaftView view(0);
  const RivalChoice choice = view.choose(0);
  EXPECT_FALSE(choice.turned);
  EXPECT_EQ(choice.T_camera_object.matrix(), view.truth.matrix());
  EXPECT_GT(choice.margin, SURE);
}

TEST(Rivals, AHiddenKeywayIsSaidToBeAmbiguous)
{
  const ShaftView view(180 * DEGREE);
  for (const double given : {180.0, 150.0, 215.0})
    EXPECT_LT(view.choose(given * DEGREE).margin, SURE) << given;
}

TEST(SurfaceShare, FallsWhereTheSceneHasAnotherShape)
{
  const ShaftView view(0);
  EXPECT_GT(surfaceShare(shaft(), view.truth, view.grid, TOLERANCE), 0.97);
  Pose aside = view.truth;
  aside.translation().z() += 0.003;  // three millimetres too deep: near, but nothing lies on the surface but its sides
  EXPECT_LT(surfaceShare(shaft(), aside, view.grid, TOLERANCE), 0.5);
  Pose away = view.truth;
  away.translation().z() += 0.2;
  EXPECT_EQ(surfaceShare(shaft(), away, view.grid, TOLERANCE), 0);
}

TEST(Rivals, WithoutNearSymmetriesThereIsNothingToChoose)
{
  TrainedModel alone = shaft();
  alone.near_symmetries.clear();
  const ShaftView view(0);
  const RivalChoice choice =
      chooseAmongRivals(alone, ShaftView::poseAt(1), view.grid, view.surroundings, TOLERANCE, SURE);
  EXPECT_FALSE(choice.turned);
  EXPECT_TRUE(std::isinf(choice.margin));
}

TEST(BinPenetration, CountsFloorAndWallsBelowTheRim)
{
  Bin bin;
  bin.inner_size = {0.4, 0.3, 0.1};
  OrientedPoints corners;
  for (int k = 0; k < 8; ++k)  // a cube of 20 mm
    corners.points.emplace_back(k & 1 ? 0.01f : -0.01f, k & 2 ? 0.01f : -0.01f, k & 4 ? 0.01f : -0.01f);
  const auto at = [&](double x, double y, double z) {
    Pose T = Pose::Identity();
    T.translation() = Eigen::Vector3d(x, y, z);
    return binPenetration(corners, T, bin);
  };
  EXPECT_EQ(at(0, 0, 0.02), 0);
  EXPECT_NEAR(at(0, 0, 0.007), 0.003, 1e-6);      // floor
  EXPECT_NEAR(at(0.194, 0, 0.05), 0.004, 1e-6);   // wall at x = 0.2
  EXPECT_NEAR(at(0, -0.145, 0.05), 0.005, 1e-6);  // wall at y = -0.15
  EXPECT_EQ(at(0.23, 0, 0.12), 0);                // on the rim
  EXPECT_NEAR(at(0.23, 0, 0.108), 0.002, 1e-6);   // a little below the rim: it may have come over it
}
}  // namespace
}  // namespace bin_picking
