// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/reference_choice.hpp"

#include <gtest/gtest.h>

#include "analytic_surfaces.hpp"
#include "bin_picking_perception/scene/surface_resampling.hpp"

namespace bin_picking
{
namespace
{
constexpr double LEAF = 0.004;
constexpr double SPACING = 0.7 * LEAF;

/// Largest distance of a point to the nearest image of a reference, the symmetry sampled finely.
double largestGap(const OrientedPoints& points, const std::vector<std::uint32_t>& references, const Symmetry& symmetry)
{
  const std::vector<Pose> images = symmetry.sampled(360);
  double largest = 0;
  for (const auto& p : points.points)
  {
    double nearest = 1;
    for (const std::uint32_t r : references)
      for (const Pose& image : images)
        nearest = std::min(nearest, (image * points.points[r].cast<double>() - p.cast<double>()).norm());
    largest = std::max(largest, nearest);
  }
  return largest;
}

Symmetry revolution()
{
  Symmetry symmetry;
  symmetry.continuous = Symmetry::Axis{Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()};
  return symmetry;
}

TEST(ReferenceChoice, oneProfileOfASolidOfRevolution)
{
  const OrientedPoints points = voxelDownsample(test::torus(0.04, 0.015, 40000), LEAF);
  const auto references = referencesUpToSymmetry(points, revolution(), SPACING);
  // The profile is a circle of 94 mm; references are more than the spacing apart on it, and every normal's side counts.
  EXPECT_LT(references.size(), static_cast<std::size_t>(2 * M_PI * 0.015 / SPACING) + 20);
  EXPECT_LT(largestGap(points, references, revolution()), 1.05 * SPACING);
}

TEST(ReferenceChoice, oneSixthOfASixfoldPart)
{
  Symmetry sixfold;
  sixfold.discrete.clear();
  for (int k = 0; k < 6; ++k)
    sixfold.discrete.push_back(Pose(Eigen::AngleAxisd(k * M_PI / 3, Eigen::Vector3d::UnitZ())));
  const OrientedPoints points = voxelDownsample(test::cylinder(0.03, 0.08, 60000), LEAF);
  const auto references = referencesUpToSymmetry(points, sixfold, SPACING);
  EXPECT_LT(references.size(), points.size() / 3);
  EXPECT_GT(references.size(), points.size() / 7);
  EXPECT_LT(largestGap(points, references, sixfold), 1.05 * SPACING);
}

TEST(ReferenceChoice, everyPointWithoutSymmetry)
{
  EXPECT_TRUE(referencesUpToSymmetry(test::torus(0.04, 0.015, 100), Symmetry(), SPACING).empty());
}
}  // namespace
}  // namespace bin_picking
