// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/refinement/rivals.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "bin_picking_perception/model/depth_renderer.hpp"
#include "bin_picking_perception/model/slight_turn.hpp"
#include "bin_picking_perception/refinement/verification.hpp"
#include "core/shaft_scene.hpp"

namespace bin_picking
{
namespace
{
constexpr double DEGREE = M_PI / 180;
constexpr double TOLERANCE = 0.0008;  // metres: what eight standard deviations of a good sensor are
constexpr double SURE = 14;           // VerificationParameters::min_turn_margin
constexpr double KEY_DEPTH = 0.005;   // metres: stepped_shaft.scad

using test::shaftPose;
using test::turnBetween;

const TrainedModel& shaft() { return *test::shaftModel(); }

std::shared_ptr<const TrainedModel> trained(const std::string& part, const TrainingParameters& parameters = {})
{
  return trainPart(loadPart(test::partFolder(part)), parameters, Executor(2));
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

TEST(DistanceField, ABlockOfPlacesGivesWhatEachGives)
{
  const double radius = 0.02;
  const double band = 0.005;
  const DistanceField field(sphere(radius), 0.001, band);
  DistanceField::Places places;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> coordinate(-0.03f, 0.03f);  // also outside of the grid
  for (std::size_t k = 0; k < DistanceField::BLOCK; ++k)
  {
    places.x[k] = coordinate(random);
    places.y[k] = coordinate(random);
    places.z[k] = coordinate(random);
  }
  places.y[3] = std::numeric_limits<float>::quiet_NaN();
  places.z[7] = std::numeric_limits<float>::infinity();
  DistanceField::Numbers distances;
  field.at(places, distances);
  DistanceField::Samples samples;
  field.sample(places, samples);
  for (std::size_t k = 0; k < DistanceField::BLOCK; ++k)
  {
    const bool finite = k != 3 && k != 7;
    const Eigen::Vector3f place(places.x[k], places.y[k], places.z[k]);
    const DistanceField::Sample one =
        finite ? field.sample(place) : DistanceField::Sample{static_cast<float>(band), {0, 0, 0}};
    EXPECT_NEAR(distances[k], one.distance, 1e-9) << k;  // rounding
    EXPECT_NEAR(samples.distance[k], one.distance, 1e-9) << k;
    const Eigen::Vector3f gradient(samples.gradient_x[k], samples.gradient_y[k], samples.gradient_z[k]);
    EXPECT_NEAR((gradient - one.gradient).norm(), 0, 1e-6) << k;
  }
}

TEST(DistanceField, WithoutASurfaceEveryPlaceIsABandAway)
{
  const DistanceField field;
  DistanceField::Numbers distances;
  field.at({}, distances);
  EXPECT_TRUE(std::all_of(distances.begin(), distances.end(), [&](float d) { return d == field.band(); }));
  DistanceField::Samples samples;
  field.sample({}, samples);
  EXPECT_EQ(samples.gradient_z[5], 0);
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

TEST(NearSymmetry, TheDepthOfTheKeywayIsItsDeviationAllAround)
{
  // Between samples, a surface seems farther by a part of their distance.
  const double tolerance = shaft().parameters.surface_spacing / 4;
  for (const NearSymmetry& near : shaft().near_symmetries)
  {
    EXPECT_TRUE(near.slight && near.slight_all_around);
    EXPECT_LT(near.deviation, KEY_DEPTH + tolerance);
    if (std::cos(angleAbout(near.axis, near.T_object_object)) < 0.9)  // else the keyway lies over itself in part
    {
      EXPECT_GT(near.deviation, KEY_DEPTH - tolerance);
    }
  }
  EXPECT_EQ(slightTurn(shaft(), rotationAbout(shaft().near_symmetries[5].axis, 90 * DEGREE)),
            &shaft().near_symmetries[5]);
  EXPECT_EQ(slightTurn(shaft(), Pose::Identity()), nullptr);
}

TEST(NearSymmetry, BranchesRibsAndWallsAreNotSlight)
{
  for (const char* part : {"three_way_tube", "upright_column", "pipe_elbow", "l_bracket", "cast_handle"})
  {
    const auto model = trained(part);
    for (const NearSymmetry& near : model->near_symmetries)
      EXPECT_FALSE(near.slight) << part << ", a turn that moves the surface by " << 1000 * near.deviation << " mm";
  }
  const auto bolt = trained("hex_bolt");
  for (const NearSymmetry& near : bolt->near_symmetries)
    if (std::abs(near.axis.direction.z()) > 0.999)
    {
      EXPECT_TRUE(near.slight_all_around) << "only the head is no body of revolution";
    }
}

TEST(NearSymmetry, WhoNeedsTheTurnSaysThatNoneIsSlight)
{
  TrainingParameters parameters;
  parameters.slight_deviation = 0;
  const auto model = trained("stepped_shaft", parameters);
  EXPECT_EQ(model->near_symmetries.size(), shaft().near_symmetries.size());
  for (const NearSymmetry& near : model->near_symmetries)
    EXPECT_FALSE(near.slight);
}

TEST(NearSymmetry, DeclaredTurnsAreNoRivals)
{
  const auto bolt = trained("hex_bolt");
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
  explicit ShaftView(double turn) : truth(shaftPose(turn))
  {
    DepthRenderer renderer(480, 384, PinholeCamera{750, 750, 239.5, 191.5});
    renderer.draw(shaft().mesh, truth, 0);
    grid = renderer.grid();
    surroundings = grid;
    for (int i = 0; i < static_cast<int>(grid.size()); ++i)
      if (!grid.valid(i))  // a floor that is not a part
      {
        const int row = i / grid.width;
        const Eigen::Vector3d p = grid.camera.backProject(i % grid.width, row, 0.66);
        surroundings.x[static_cast<std::size_t>(i)] = static_cast<float>(p.x());
        surroundings.y[static_cast<std::size_t>(i)] = static_cast<float>(p.y());
        surroundings.z[static_cast<std::size_t>(i)] = static_cast<float>(p.z());
      }
  }

  /// Without refinement: what is given is at its place but for the turn.
  RivalChoice choose(double given, const TrainedModel& model = shaft()) const
  {
    return chooseAmongRivals(model, shaftPose(given), grid, surroundings, TOLERANCE, SURE,
                             [](const Pose& pose) { return pose; });
  }

  Pose truth;
  DepthGrid grid;
  DepthGrid surroundings;
};

TEST(Rivals, AKeywayInViewTurnsTheShaftTheRightWay)
{
  const ShaftView view(20 * DEGREE);
  for (const double off : {95.0, -60.0, 172.0})
  {
    const RivalChoice choice = view.choose((20 + off) * DEGREE);
    EXPECT_TRUE(choice.turned);
    EXPECT_LT(turnBetween(choice.T_camera_object, view.truth), 5 * DEGREE) << "given " << off << " degrees off";
    EXPECT_GT(choice.margin, SURE);
    EXPECT_FALSE(choice.undetermined_turn);
  }
}

TEST(Rivals, AWrongPoseBesideThePlaceOfTheRightOneIsTurnedToThatPlace)
{
  const ShaftView view(20 * DEGREE);
  TrainedModel model = shaft();  // as if not every turn about its axis took it to the same place
  for (NearSymmetry& near : model.near_symmetries)
    near.slight = near.slight_all_around = false;
  // A wrong turn, and refined to where it explains most: two tolerances along the axis from the right place.
  Pose beside = shaftPose(110 * DEGREE);
  beside.translation() += 2 * TOLERANCE * beside.linear().col(2);
  const auto refine = [&](Pose pose) {
    if (turnBetween(pose, view.truth) < 10 * DEGREE)
      pose.translation() = view.truth.translation();
    return pose;
  };
  const RivalChoice choice = chooseAmongRivals(model, beside, view.grid, view.surroundings, TOLERANCE, SURE, refine);
  EXPECT_TRUE(choice.turned);
  EXPECT_LT(turnBetween(choice.T_camera_object, view.truth), 5 * DEGREE);
  EXPECT_LT((choice.T_camera_object.translation() - view.truth.translation()).norm(), 1e-6);
  EXPECT_GT(choice.margin, SURE);
}

TEST(Rivals, ARightPoseIsKeptBitForBit)
{
  const ShaftView view(0);
  const RivalChoice choice = view.choose(0);
  EXPECT_FALSE(choice.turned);
  EXPECT_EQ(choice.T_camera_object.matrix(), view.truth.matrix());
  EXPECT_GT(choice.margin, SURE);
}

TEST(Rivals, AHiddenKeywayLeavesTheTurnOpenAndNothingElse)
{
  const ShaftView view(180 * DEGREE);
  for (const double given : {180.0, 150.0, 215.0})
  {
    const RivalChoice choice = view.choose(given * DEGREE);
    EXPECT_LT(choice.margin, SURE) << given;
    EXPECT_TRUE(std::isinf(choice.margin_beyond_turn)) << "its turns are all that nearly keep a shaft";
    ASSERT_TRUE(choice.undetermined_turn);
    EXPECT_GT(choice.undetermined_turn->axis.direction.z(), 0.9999);
    EXPECT_LT(choice.undetermined_turn->axis.origin.head<2>().norm(), 1e-4);
    EXPECT_TRUE(choice.undetermined_turn->angles.empty()) << "any turn";
    EXPECT_NEAR(choice.undetermined_turn->deviation, KEY_DEPTH, shaft().parameters.surface_spacing / 4);
    EXPECT_LT(test::tiltBetween(choice.T_camera_object, view.truth), 1e-6);
    const std::string text = describe(*choice.undetermined_turn);
    EXPECT_EQ(text.find("its turn about the axis z through"), 0u) << text;
  }
}

TEST(Rivals, OnlySlightTurnsMayBeLeftOpen)
{
  const ShaftView view(180 * DEGREE);
  TrainedModel strict = shaft();
  for (NearSymmetry& near : strict.near_symmetries)
    near.slight = near.slight_all_around = false;
  const RivalChoice ambiguous = view.choose(180 * DEGREE, strict);
  EXPECT_FALSE(ambiguous.undetermined_turn);
  EXPECT_LT(ambiguous.margin_beyond_turn, SURE);

  // Were one of the turns no slight one, the pose would be ambiguous however slight the others are.
  TrainedModel mixed = shaft();
  for (NearSymmetry& near : mixed.near_symmetries)
  {
    near.slight_all_around = false;
    near.slight = std::abs(angleAbout(near.axis, near.T_object_object) - 45 * DEGREE) > DEGREE;
  }
  EXPECT_LT(view.choose(180 * DEGREE, mixed).margin_beyond_turn, SURE);
}

TEST(Rivals, ASingleTurnIsLeftOpenAsSuch)
{
  const ShaftView view(180 * DEGREE);
  TrainedModel single = shaft();  // as if it equalled itself, nearly, after these turns alone
  single.near_symmetries.clear();
  for (NearSymmetry near : shaft().near_symmetries)
    if (const double angle = angleAbout(near.axis, near.T_object_object);
        std::abs(std::cos(angle) - std::cos(45 * DEGREE)) < 0.01)
    {
      near.slight_all_around = false;
      single.near_symmetries.push_back(near);
    }
  const RivalChoice choice = view.choose(180 * DEGREE, single);
  ASSERT_TRUE(choice.undetermined_turn);
  ASSERT_EQ(choice.undetermined_turn->angles.size(), 2u);
  EXPECT_NEAR(choice.undetermined_turn->angles[0], 45 * DEGREE, 1e-9);
  EXPECT_NEAR(choice.undetermined_turn->angles[1], 315 * DEGREE, 1e-9);
  EXPECT_EQ(describe(*choice.undetermined_turn).find("it may as well be turned by 45 or 315 deg about the axis z"), 0u);
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
  const RivalChoice choice = view.choose(1, alone);
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
