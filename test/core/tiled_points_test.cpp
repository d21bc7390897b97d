// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "../../src/core/scene/tiled_points.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "../../src/core/scene/voxel_order.hpp"
#include "analytic_surfaces.hpp"
#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/scene/curvature.hpp"

namespace bin_picking
{
namespace
{
constexpr float RADIUS = 0.01f;
constexpr float MIN_COSINE = 0.5f;

/// Some 1300 neighbours, more than a Neighbourhood holds at a time, and the tube's far side within the radius.
OrientedPoints thinTorus() { return test::torus(0.03, 0.004, 36000); }

std::vector<std::size_t> neighboursOf(std::size_t query, const OrientedPoints& points)
{
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < points.size(); ++i)
    if ((points.points[i] - points.points[query]).norm() < RADIUS &&
        points.normals[i].dot(points.normals[query]) >= MIN_COSINE)
      near.push_back(i);
  return near;
}
}  // namespace

TEST(TiledPoints, MomentsAreThoseOfAllNeighbours)
{
  const OrientedPoints points = thinTorus();
  const TiledPoints tiled(points, RADIUS);
  for (std::size_t query = 0; query < points.size(); query += 997)
  {
    PlaneMoments expected;
    for (const std::size_t i : neighboursOf(query, points))
    {
      const Eigen::Vector3d d = (points.points[i] - points.points[query]).cast<double>();
      expected.count += 1;
      expected.sum += d;
      expected.products += d * d.transpose();
    }
    const PlaneMoments found = tiled.planeMoments(points.points[query], points.normals[query], MIN_COSINE);
    ASSERT_GT(expected.count, 100);
    // A point on the rim of the ball or of the cone may fall on either side of it by rounding.
    EXPECT_NEAR(found.count, expected.count, 1);
    const double reach = static_cast<double>(RADIUS);
    EXPECT_LT((found.sum - expected.sum).norm(), 1.1 * reach);
    EXPECT_LT((found.products - expected.products).norm(), 1.1 * reach * reach);
  }
}

TEST(TiledPoints, QuadricMomentsAreThoseOfAllNeighbours)
{
  const OrientedPoints points = thinTorus();
  const TiledPoints tiled(points, RADIUS);
  for (std::size_t query = 0; query < points.size(); query += 997)
  {
    const Eigen::Matrix3f frame = tangentFrame(points.normals[query], static_cast<double>(RADIUS));
    const std::vector<std::size_t> neighbours = neighboursOf(query, points);
    Eigen::MatrixXd terms(neighbours.size(), 6);
    Eigen::VectorXd heights(neighbours.size());
    for (std::size_t k = 0; k < neighbours.size(); ++k)
    {
      const Eigen::Vector3d p = (frame * (points.points[neighbours[k]] - points.points[query])).cast<double>();
      const auto row = static_cast<Eigen::Index>(k);
      terms.row(row) << p.x() * p.x(), p.x() * p.y(), p.y() * p.y(), p.x(), p.y(), 1;
      heights[row] = p.z();
    }
    const Eigen::VectorXd q = terms.colPivHouseholderQr().solve(heights);
    const QuadricMoments moments = tiled.quadricMoments(points.points[query], points.normals[query], frame, MIN_COSINE);
    // A point on the rim may fall on either side of it: one of more than a hundred.
    EXPECT_NEAR(moments.count(), static_cast<double>(neighbours.size()), 1);
    const double expected = quadricCurvature(q[0], q[1], q[2], q[3], q[4]).mean;
    EXPECT_NEAR(moments.meanCurvature(), expected, 0.02 * std::abs(expected));
  }
}

TEST(TiledPoints, NeighbourhoodsHoldEachNeighbourOnce)
{
  const OrientedPoints points = thinTorus();
  const TiledPoints tiled(points, RADIUS);
  Neighbourhood memory;
  std::size_t most = 0;
  for (std::size_t query = 0; query < points.size(); query += 997)
  {
    const Eigen::Vector3f& centre = points.points[query];
    std::vector<std::array<float, 3>> found;
    tiled.forEachNeighbourhood(centre, points.normals[query], MIN_COSINE, memory, [&](const Neighbourhood& some) {
      for (std::size_t k = 0; k < some.size; ++k)
        found.push_back({some.x[k], some.y[k], some.z[k]});
      for (std::size_t k = some.size; k % Neighbourhood::LANES != 0; ++k)
        EXPECT_EQ(some.weight[k], 0);
    });
    std::vector<std::array<float, 3>> expected;
    for (const std::size_t i : neighboursOf(query, points))
    {
      const Eigen::Vector3f d = points.points[i] - centre;
      expected.push_back({d.x(), d.y(), d.z()});
    }
    std::sort(found.begin(), found.end());
    EXPECT_EQ(std::unique(found.begin(), found.end()), found.end());
    EXPECT_NEAR(static_cast<double>(found.size()), static_cast<double>(expected.size()), 1);
    most = std::max(most, found.size());
  }
  EXPECT_GT(most, Neighbourhood::CAPACITY) << "nothing was asked for that comes in more than one piece";
}

TEST(VoxelOrder, PointsOfAVoxelAreSideBySideInTheirOwnOrder)
{
  constexpr float LEAF = 0.003f;
  const OrientedPoints points = thinTorus();
  const std::vector<VoxelMember> order = voxelOrder(points.points, static_cast<double>(LEAF));
  ASSERT_EQ(order.size(), points.size());
  const auto cell = [&](const VoxelMember& member) {
    const Eigen::Vector3f q = points.points[member.point] * (1 / LEAF);
    return std::array<float, 3>{std::floor(q.z()), std::floor(q.y()), std::floor(q.x())};
  };
  for (std::size_t i = 1; i < order.size(); ++i)
  {
    ASSERT_LE(cell(order[i - 1]), cell(order[i]));
    ASSERT_EQ(order[i - 1].voxel == order[i].voxel, cell(order[i - 1]) == cell(order[i]));
    if (order[i - 1].voxel == order[i].voxel)
    {
      ASSERT_LT(order[i - 1].point, order[i].point);
    }
  }
}

TEST(VoxelOrder, AStrayPointFarAwayDisturbsNothing)
{
  const std::vector<Eigen::Vector3f> points = {{0, 9000, 0}, {0.010f, 0, 0}, {0.001f, 0, 0}, {0.011f, 0, 0}};
  const std::vector<VoxelMember> order = voxelOrder(points, 0.003);
  ASSERT_EQ(order.size(), 4u);
  EXPECT_EQ(order[0].point, 2u);
  EXPECT_EQ(order[1].point, 1u);
  EXPECT_EQ(order[2].point, 3u);
  EXPECT_EQ(order[3].point, 0u);
  EXPECT_EQ(order[1].voxel, order[2].voxel);
}

TEST(VoxelOrder, APointThatNoNumberReachesIsNamed)
{
  try
  {
    voxelOrder({Eigen::Vector3f::Zero(), Eigen::Vector3f(0, 9e8f, 0)}, 0.003);
    FAIL() << "nothing was said";
  }
  catch (const ParameterError& error)
  {
    EXPECT_NE(std::string(error.what()).find("9000"), std::string::npos) << error.what();
  }
}
}  // namespace bin_picking
