// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/grasp_expansion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
using Eigen::Vector3d;

constexpr double DEGREE = M_PI / 180;

/// From +x of the part, closing along its y.
GraspDefinition fromTheSide(const std::string& id)
{
  GraspDefinition grasp;
  grasp.id = id;
  grasp.T_object_tip.linear().col(2) = -Vector3d::UnitX();
  grasp.T_object_tip.linear().col(1) = Vector3d::UnitY();
  grasp.T_object_tip.linear().col(0) = Vector3d::UnitY().cross(-Vector3d::UnitX());
  grasp.T_object_tip.translation() = Vector3d(0.01, 0, 0.05);
  grasp.width = 0.02;
  grasp.opening = 0.05;
  return grasp;
}

PartDefinition partWith(const std::vector<GraspDefinition>& grasps, int order = 1)
{
  PartDefinition part;
  part.grasps = grasps;
  const Symmetry::Axis axis = {Vector3d::UnitZ(), Vector3d::Zero()};
  if (order > 1)
    part.symmetry.discrete = closeUnderComposition({rotationAbout(axis, 2 * M_PI / order)});
  return part;
}

TEST(GraspExpansion, aPlainGraspIsItself)
{
  const PartDefinition part = partWith({fromTheSide("a")});
  const auto variants = expandGrasps(part, 12);
  ASSERT_EQ(variants.size(), 1u);
  EXPECT_EQ(variants[0].symmetry_variant, 0);
  EXPECT_EQ(variants[0].tilt, 0);
  EXPECT_EQ(variants[0].spin, 0);
  EXPECT_EQ(variants[0].T_object_tip.matrix(), part.grasps[0].T_object_tip.matrix());
}

TEST(GraspExpansion, copiesAreHeldWhereTheirCorrectionSays)
{
  const PartDefinition part = partWith({fromTheSide("a")}, 4);
  const auto variants = expandGrasps(part, 12);
  ASSERT_EQ(variants.size(), 4u);
  for (int k = 0; k < 4; ++k)
  {
    const GraspVariant& variant = variants[static_cast<std::size_t>(k)];
    EXPECT_EQ(variant.symmetry_variant, k);
    const Pose& copy = part.symmetry.discrete[static_cast<std::size_t>(k)];
    EXPECT_LT((variant.T_object_tip.matrix() - (copy * part.grasps[0].T_object_tip).matrix()).norm(), 1e-12);
    EXPECT_LT(((variant.T_object_tip * variant.T_tip_object).matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-12);
  }
  PartDefinition asymmetric = part;
  asymmetric.grasps[0].symmetric = false;
  EXPECT_EQ(expandGrasps(asymmetric, 12).size(), 1u);
}

TEST(GraspExpansion, anAxisOfRevolutionIsSampled)
{
  PartDefinition part = partWith({fromTheSide("a")});
  part.symmetry.continuous = Symmetry::Axis{Vector3d::UnitZ(), Vector3d::Zero()};
  EXPECT_EQ(expandGrasps(part, 12).size(), 12u);
  EXPECT_THROW(expandGrasps(part, 0), ParameterError);
}

// A grasp that is written down on a side which the symmetry offers already adds nothing.
TEST(GraspExpansion, duplicatesAreLeftOut)
{
  PartDefinition part = partWith({fromTheSide("a"), fromTheSide("b")}, 2);
  part.grasps[1].T_object_tip = part.symmetry.discrete[1] * part.grasps[1].T_object_tip;
  part.grasps[1].T_object_tip.translation().z() += 0.00005;
  auto variants = expandGrasps(part, 12);
  ASSERT_EQ(variants.size(), 2u);
  EXPECT_EQ(variants[1].grasp, 0u);
  part.grasps[1].T_object_tip.translation().z() += 0.0002;
  EXPECT_EQ(expandGrasps(part, 12).size(), 4u);
  part.grasps[1].T_object_tip.translation().z() -= 0.0002;
  part.grasps[1].opening = 0.08;  // the same place with more room is another offer
  EXPECT_EQ(expandGrasps(part, 12).size(), 4u);
}

TEST(GraspExpansion, ofEqualPosesThePreferredIsKept)
{
  PartDefinition part = partWith({fromTheSide("spare"), fromTheSide("elsewhere"), fromTheSide("preferred")});
  part.grasps[1].T_object_tip.translation().z() = 0.02;
  part.grasps[2].priority = 1;
  auto variants = expandGrasps(part, 12);
  ASSERT_EQ(variants.size(), 2u);
  EXPECT_EQ(variants[0].grasp, 1u) << "what is left keeps its order";
  EXPECT_EQ(variants[1].grasp, 2u);

  part.grasps[0].priority = 2;
  variants = expandGrasps(part, 12);
  ASSERT_EQ(variants.size(), 2u);
  EXPECT_EQ(variants[0].grasp, 0u);
  EXPECT_EQ(variants[1].grasp, 1u);

  // As written comes before what a tolerance offers, whatever its priority.
  part = partWith({fromTheSide("written"), fromTheSide("tilted")});
  part.grasps[1].T_object_tip = part.grasps[1].T_object_tip * Eigen::AngleAxisd(20 * DEGREE, Vector3d::UnitY());
  part.grasps[1].tilt_tolerance = 20 * DEGREE;
  part.grasps[1].priority = 5;
  variants = expandGrasps(part, 12);
  ASSERT_EQ(variants.size(), 5u);  // the one at -20 degrees stands there already
  EXPECT_EQ(variants[0].grasp, 0u);
}

TEST(GraspExpansion, tiltKeepsPointAndClosingAxis)
{
  PartDefinition part = partWith({fromTheSide("a")});
  part.grasps[0].tilt_tolerance = 20 * DEGREE;
  const auto variants = expandGrasps(part, 12);
  ASSERT_EQ(variants.size(), 5u);
  std::set<double> tilts;
  for (const GraspVariant& variant : variants)
  {
    EXPECT_LT((variant.T_object_tip.translation() - part.grasps[0].T_object_tip.translation()).norm(), 1e-12);
    EXPECT_LT((variant.T_object_tip.linear().col(1) - Vector3d::UnitY()).norm(), 1e-12);
    const double angle = std::acos(std::clamp(variant.T_object_tip.linear().col(2).dot(-Vector3d::UnitX()), -1.0, 1.0));
    EXPECT_NEAR(angle, std::abs(variant.tilt), 1e-7);
    tilts.insert(std::round(variant.tilt / DEGREE));
  }
  EXPECT_EQ(tilts, (std::set<double>{-20, -10, 0, 10, 20}));
}

TEST(GraspExpansion, spinKeepsPointAndApproach)
{
  PartDefinition part = partWith({fromTheSide("a")});
  part.grasps[0].spin_tolerance = M_PI;
  const auto variants = expandGrasps(part, 12);
  ASSERT_EQ(variants.size(), 4u);  // half a turn to the right is half a turn to the left
  for (const GraspVariant& variant : variants)
    EXPECT_LT((variant.T_object_tip.linear().col(2) + Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_NEAR(variants[1].T_object_tip.linear().col(1).dot(Vector3d::UnitY()), 0, 1e-12);
}

TEST(GraspExpansion, asWrittenComesFirst)
{
  PartDefinition part = partWith({fromTheSide("a"), fromTheSide("b")}, 3);
  part.grasps[1].T_object_tip.translation().z() = 0.02;
  for (GraspDefinition& grasp : part.grasps)
  {
    grasp.tilt_tolerance = 30 * DEGREE;
    grasp.spin_tolerance = 10 * DEGREE;
  }
  const auto variants = expandGrasps(part, 12);
  ASSERT_EQ(variants.size(), 2u * 3u * 25u);
  double before = 0;
  for (std::size_t k = 0; k < variants.size(); ++k)
  {
    const double share = std::abs(variants[k].tilt) / (30 * DEGREE) + std::abs(variants[k].spin) / (10 * DEGREE);
    EXPECT_GE(share, before - 1e-12);
    before = share;
    EXPECT_EQ(share == 0, k < 6) << k;
  }
}
}  // namespace
}  // namespace bin_picking
