// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/pose_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
using Eigen::AngleAxisd;
using Eigen::Translation3d;
using Eigen::Vector3d;

/// Surface points of a box of 80 x 40 x 20 mm at 4 mm: well apart, so that a point's nearest neighbour is known.
std::vector<Eigen::Vector3f> boxPoints()
{
  std::vector<Eigen::Vector3f> points;
  for (int i = -10; i <= 10; ++i)
    for (int j = -5; j <= 5; ++j)
      for (int k : {-1, 1})
        points.emplace_back(0.004f * static_cast<float>(i), 0.004f * static_cast<float>(j),
                            0.01f * static_cast<float>(k));
  return points;
}

Pose somePose() { return Translation3d(0.1, -0.2, 0.8) * AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()); }

Symmetry twofoldAboutZ()
{
  Symmetry symmetry;
  symmetry.discrete.emplace_back(AngleAxisd(M_PI, Vector3d::UnitZ()));
  return symmetry;
}

Symmetry revolutionAboutX(const Vector3d& origin)
{
  Symmetry symmetry;
  symmetry.continuous = Symmetry::Axis{Vector3d::UnitX(), origin};
  return symmetry;
}

TEST(PoseError, APerfectPoseHasNone)
{
  const Pose truth = somePose();
  const PoseError error = poseError(truth, truth, Symmetry());
  EXPECT_NEAR(error.translation, 0, 1e-12);
  EXPECT_NEAR(error.rotation, 0, 1e-12);
  EXPECT_NEAR(averageDistance(boxPoints(), truth, truth), 0, 1e-12);
  EXPECT_NEAR(averageNearestDistance(boxPoints(), truth, truth), 0, 1e-7);  // the search works in single precision
  EXPECT_NEAR(maximumSymmetryAwareDistance(boxPoints(), truth, truth, Symmetry()), 0, 1e-12);
}

TEST(PoseError, AKnownShiftIsReportedByEveryMeasure)
{
  const Pose truth = somePose();
  // 1.5 mm is less than half the spacing of the points: the nearest point is the corresponding one.
  const Pose estimate = truth * Translation3d(0.0015, 0, 0);
  const PoseError error = poseError(estimate, truth, Symmetry());
  EXPECT_NEAR(error.translation, 0.0015, 1e-12);
  EXPECT_NEAR(error.rotation, 0, 1e-12);
  EXPECT_NEAR(averageDistance(boxPoints(), estimate, truth), 0.0015, 1e-12);
  EXPECT_NEAR(averageNearestDistance(boxPoints(), estimate, truth), 0.0015, 1e-7);
  EXPECT_NEAR(maximumSymmetryAwareDistance(boxPoints(), estimate, truth, Symmetry()), 0.0015, 1e-9);
}

TEST(PoseError, AKnownTurnMovesTheFarthestPointMost)
{
  const Pose truth = somePose();
  const double angle = 0.02;
  const Pose estimate = truth * AngleAxisd(angle, Vector3d::UnitZ());
  const PoseError error = poseError(estimate, truth, Symmetry());
  EXPECT_NEAR(error.translation, 0, 1e-12);
  EXPECT_NEAR(error.rotation, angle, 1e-12);
  // The corner lies sqrt(40^2 + 20^2) mm from the axis and moves along a chord.
  const double corner = 2 * std::sin(angle / 2) * std::hypot(0.04, 0.02);
  EXPECT_NEAR(maximumSymmetryAwareDistance(boxPoints(), estimate, truth, Symmetry()), corner, 1e-8);
  EXPECT_LT(averageDistance(boxPoints(), estimate, truth), corner);
}

TEST(PoseError, TinyRotationsKeepTheirDigits)
{
  const Pose estimate(AngleAxisd(1e-9, Vector3d::UnitY()));
  EXPECT_NEAR(poseError(estimate, Pose::Identity(), Symmetry()).rotation, 1e-9, 1e-13);
}

TEST(PoseError, ADiscreteEquivalentIsNoError)
{
  const Pose truth = somePose();
  const Pose estimate = truth * AngleAxisd(M_PI, Vector3d::UnitZ());
  const PoseError error = poseError(estimate, truth, twofoldAboutZ());
  EXPECT_NEAR(error.translation, 0, 1e-12);
  EXPECT_NEAR(error.rotation, 0, 1e-7);
  EXPECT_NEAR(maximumSymmetryAwareDistance(boxPoints(), estimate, truth, twofoldAboutZ()), 0, 1e-9);
  EXPECT_NEAR(averageNearestDistance(boxPoints(), estimate, truth), 0, 1e-7);

  // Without the symmetry the same pose is as wrong as can be, except for ADD-S, which is blind to it.
  EXPECT_NEAR(poseError(estimate, truth, Symmetry()).rotation, M_PI, 1e-7);
  EXPECT_NEAR(maximumSymmetryAwareDistance(boxPoints(), estimate, truth, Symmetry()), 2 * std::hypot(0.04, 0.02), 1e-8);
  EXPECT_GT(averageDistance(boxPoints(), estimate, truth), 0.02);
}

TEST(PoseError, SymmetryDoesNotHideOtherErrors)
{
  const Pose truth = somePose();
  const Pose estimate =
      truth * AngleAxisd(M_PI, Vector3d::UnitZ()) * Translation3d(0, 0, 0.003) * AngleAxisd(0.05, Vector3d::UnitX());
  const PoseError error = poseError(estimate, truth, twofoldAboutZ());
  EXPECT_NEAR(error.translation, 0.003, 1e-9);
  EXPECT_NEAR(error.rotation, 0.05, 1e-9);
}

TEST(PoseError, AnyTurnAboutAnAxisOfRevolutionIsNoError)
{
  // The axis does not pass through the origin of the part frame.
  const Vector3d origin(0, 0.02, -0.01);
  const Symmetry symmetry = revolutionAboutX(origin);
  const Pose truth = somePose();
  for (const double angle : {0.3, 1.2345, 3.0, -2.2})
  {
    const Pose turn = Translation3d(origin) * AngleAxisd(angle, Vector3d::UnitX()) * Translation3d(-origin);
    const Pose estimate = truth * turn;
    const PoseError error = poseError(estimate, truth, symmetry, origin);
    EXPECT_NEAR(error.translation, 0, 1e-9);
    EXPECT_NEAR(error.rotation, 0, 1e-7);
    EXPECT_NEAR(maximumSymmetryAwareDistance(boxPoints(), estimate, truth, symmetry), 0, 1e-8);
  }
}

TEST(PoseError, ATiltOfAnAxisOfRevolutionIsAnError)
{
  const Symmetry symmetry = revolutionAboutX(Vector3d::Zero());
  const Pose truth = somePose();
  const Pose estimate = truth * AngleAxisd(0.1, Vector3d::UnitZ()) * AngleAxisd(1.7, Vector3d::UnitX());
  EXPECT_NEAR(poseError(estimate, truth, symmetry).rotation, 0.1, 1e-7);
}

TEST(PoseError, TranslationIsComparedAtTheCenter)
{
  // A turn about a point away from the origin moves the origin but not that point.
  const Vector3d center(0.1, 0, 0);
  const Pose turn = Translation3d(center) * AngleAxisd(0.2, Vector3d::UnitZ()) * Translation3d(-center);
  EXPECT_NEAR(poseError(turn, Pose::Identity(), Symmetry(), center).translation, 0, 1e-12);
  EXPECT_NEAR(poseError(turn, Pose::Identity(), Symmetry()).translation, 2 * std::sin(0.1) * 0.1, 1e-12);
}

TEST(PoseError, NothingToMeasureIsRefused)
{
  const Pose pose = somePose();
  EXPECT_THROW(averageDistance({}, pose, pose), ParameterError);
  EXPECT_THROW(averageNearestDistance({}, pose, pose), ParameterError);
  EXPECT_THROW(maximumSymmetryAwareDistance({}, pose, pose, Symmetry()), ParameterError);
  EXPECT_THROW(maximumSymmetryAwareDistance(boxPoints(), pose, pose, Symmetry(), 0), ParameterError);
}
}  // namespace
}  // namespace bin_picking
