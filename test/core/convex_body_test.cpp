// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/convex_body.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
using Eigen::Vector3d;

struct OrientedBox
{
  Pose T_frame_box = Pose::Identity();
  Vector3d half_size = Vector3d::Zero();
};

ConvexBody bodyOf(const OrientedBox& box)
{
  return transformed(makeBox(Vector3d::Zero(), 2 * box.half_size), box.T_frame_box);
}

double boxClearance(const OrientedBox& a, const OrientedBox& b) { return clearance(bodyOf(a), bodyOf(b)); }

double sweptBoxClearance(const OrientedBox& moving, const Vector3d& motion, const OrientedBox& fixed)
{
  return clearance(swept(bodyOf(moving), motion), bodyOf(fixed));
}

OrientedBox boxAt(const Vector3d& center, const Vector3d& half_size,
                  const Eigen::Quaterniond& rotation = Eigen::Quaterniond::Identity())
{
  OrientedBox box;
  box.T_frame_box = Eigen::Translation3d(center) * rotation;
  box.half_size = half_size;
  return box;
}

class RandomBoxes
{
public:
  explicit RandomBoxes(std::uint32_t seed) : engine_(seed) {}

  double uniform(double low, double high) { return low + (high - low) * (engine_() / 4294967296.0); }
  Vector3d vector(double low, double high) { return {uniform(low, high), uniform(low, high), uniform(low, high)}; }
  OrientedBox box(double spread)
  {
    Eigen::Quaterniond rotation(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    rotation.normalize();
    return boxAt(vector(-spread, spread), vector(0.01, 0.1), rotation);
  }

private:
  std::mt19937 engine_;
};

/// Points on the surface of a box on a grid of (n + 1) per edge, faces included.
std::vector<Vector3d> surfacePoints(const OrientedBox& box, int n)
{
  std::vector<Vector3d> points;
  for (int face = 0; face < 6; ++face)
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j)
      {
        Vector3d unit;
        unit[face % 3] = face < 3 ? 1 : -1;
        unit[(face + 1) % 3] = 2.0 * i / n - 1;
        unit[(face + 2) % 3] = 2.0 * j / n - 1;
        points.push_back(box.T_frame_box * unit.cwiseProduct(box.half_size));
      }
  return points;
}

/// Exact distance of a point from a solid box; 0 inside.
double distanceTo(const OrientedBox& box, const Vector3d& point)
{
  const Vector3d local = box.T_frame_box.inverse() * point;
  return (local.cwiseAbs() - box.half_size).cwiseMax(0.0).norm();
}

double sampledDistance(const OrientedBox& a, const OrientedBox& b, int n)
{
  double smallest = std::numeric_limits<double>::infinity();
  for (const Vector3d& point : surfacePoints(a, n))
    smallest = std::min(smallest, distanceTo(b, point));
  for (const Vector3d& point : surfacePoints(b, n))
    smallest = std::min(smallest, distanceTo(a, point));
  return smallest;
}

/// Directions evenly over the sphere (Fibonacci spiral).
std::vector<Vector3d> directions(int count)
{
  const double golden = M_PI * (3 - std::sqrt(5.0));
  std::vector<Vector3d> result;
  for (int i = 0; i < count; ++i)
  {
    const double z = 1 - (2.0 * i + 1) / count;
    const double r = std::sqrt(1 - z * z);
    result.emplace_back(r * std::cos(golden * i), r * std::sin(golden * i), z);
  }
  return result;
}

double reach(const OrientedBox& box, const Vector3d& axis)
{
  return (box.T_frame_box.linear().transpose() * axis).cwiseAbs().dot(box.half_size);
}

TEST(BoxClearance, AlignedBoxesHaveTheObviousClearance)
{
  const OrientedBox cube = boxAt({0, 0, 0}, {0.5, 0.5, 0.5});
  EXPECT_NEAR(boxClearance(cube, boxAt({1.3, 0.2, -0.1}, {0.5, 0.5, 0.5})), 0.3, 1e-12);
  EXPECT_NEAR(boxClearance(cube, boxAt({1.0, 0, 0}, {0.5, 0.5, 0.5})), 0.0, 1e-12);
  EXPECT_NEAR(boxClearance(cube, boxAt({0.8, 0.1, 0.3}, {0.5, 0.5, 0.5})), -0.2, 1e-12);
  EXPECT_NEAR(boxClearance(cube, cube), -1.0, 1e-12);
}

TEST(BoxClearance, CrossingEdgesAreExact)
{
  // Two cubes standing on an edge, one above the other and turned by 90 degrees: edge against edge, which only the
  // cross product of the edges separates.
  const Eigen::Quaterniond about_x(Eigen::AngleAxisd(M_PI / 4, Vector3d::UnitX()));
  const Eigen::Quaterniond about_y(Eigen::AngleAxisd(M_PI / 4, Vector3d::UnitY()));
  const OrientedBox lower = boxAt({0, 0, 0}, {0.5, 0.5, 0.5}, about_x);
  const double tops = std::sqrt(2.0);
  EXPECT_NEAR(boxClearance(lower, boxAt({0, 0, tops + 0.1}, {0.5, 0.5, 0.5}, about_y)), 0.1, 1e-12);
  EXPECT_NEAR(boxClearance(lower, boxAt({0, 0, tops - 0.1}, {0.5, 0.5, 0.5}, about_y)), -0.1, 1e-12);
}

TEST(BoxClearance, ApartTheClearanceIsALowerBoundOfTheDistance)
{
  RandomBoxes random(1);
  int apart = 0;
  for (int i = 0; i < 300; ++i)
  {
    const OrientedBox a = random.box(0.15);
    const OrientedBox b = random.box(0.15);
    const double clearance = boxClearance(a, b);
    EXPECT_NEAR(clearance, boxClearance(b, a), 1e-12);
    if (clearance <= 0)
      continue;
    ++apart;
    // The sampled distance errs upwards by at most the half diagonal of a cell of the grid (0.2 / 16 per side), and by
    // less the larger the distance is.
    const double distance = sampledDistance(a, b, 16);
    EXPECT_GE(distance, clearance - 1e-12) << "pair " << i;
    EXPECT_LE(distance, std::sqrt(3.0) * clearance + 0.009) << "pair " << i;
  }
  EXPECT_GT(apart, 50);
}

TEST(BoxClearance, OverlappingTheClearanceIsTheShortestWayOut)
{
  // Duality: the penetration depth is the smallest overlap of the shadows over all directions. 4000 directions come
  // within 0.03 rad of any; the shadows change by at most the size of the boxes times that angle.
  const std::vector<Vector3d> axes = directions(4000);
  RandomBoxes random(2);
  int overlapping = 0;
  for (int i = 0; i < 300; ++i)
  {
    const OrientedBox a = random.box(0.06);
    const OrientedBox b = random.box(0.06);
    const double clearance = boxClearance(a, b);
    if (clearance >= 0)
      continue;
    ++overlapping;
    const Vector3d offset = a.T_frame_box.translation() - b.T_frame_box.translation();
    double depth = std::numeric_limits<double>::infinity();
    for (const Vector3d& axis : axes)
      depth = std::min(depth, reach(a, axis) + reach(b, axis) - std::abs(axis.dot(offset)));
    EXPECT_GE(depth, -clearance - 1e-12) << "pair " << i;
    EXPECT_LE(depth, -clearance + 0.012) << "pair " << i;
  }
  EXPECT_GT(overlapping, 100);
}

TEST(BoxClearance, APointOfOneInsideTheOtherMeansOverlap)
{
  RandomBoxes random(3);
  int touching = 0;
  for (int i = 0; i < 1000; ++i)
  {
    const OrientedBox a = random.box(0.1);
    const OrientedBox b = random.box(0.1);
    const bool found = sampledDistance(a, b, 8) == 0;
    touching += found;
    if (found)
    {
      EXPECT_LE(boxClearance(a, b), 0) << "pair " << i;
    }
    // A grid of 0.2 / 8 misses only overlaps that are shallower than it.
    else
    {
      EXPECT_GE(boxClearance(a, b), -0.025) << "pair " << i;
    }
  }
  EXPECT_GT(touching, 200);
  EXPECT_LT(touching, 900);
}

TEST(SweptBox, WithoutMotionItIsTheBox)
{
  RandomBoxes random(4);
  for (int i = 0; i < 100; ++i)
  {
    const OrientedBox a = random.box(0.1);
    const OrientedBox b = random.box(0.1);
    EXPECT_DOUBLE_EQ(sweptBoxClearance(a, Vector3d::Zero(), b), boxClearance(a, b));
  }
}

TEST(SweptBox, AThinPlateInTheWayIsNotJumpedOver)
{
  const OrientedBox plate = boxAt({0, 0, 0}, {2, 2, 1e-5});
  const OrientedBox finger = boxAt({0.1, 0.2, 0.3}, {0.01, 0.01, 0.02});
  EXPECT_NEAR(boxClearance(finger, plate), 0.28, 1e-4);
  EXPECT_NEAR(sweptBoxClearance(finger, {0, 0, -0.25}, plate), 0.03, 1e-4);
  // The shortest way out of the plate is back up: the lowest point of the sweep is 0.32 below it.
  EXPECT_NEAR(sweptBoxClearance(finger, {0, 0, -0.6}, plate), -0.32, 1e-4);
}

TEST(SweptBox, AgreesWithManySmallSteps)
{
  RandomBoxes random(5);
  int apart = 0;
  int overlapping = 0;
  for (int i = 0; i < 100; ++i)
  {
    const OrientedBox a = random.box(0.2);
    const OrientedBox b = random.box(0.2);
    const Vector3d motion = random.vector(-0.3, 0.3);
    const double clearance = sweptBoxClearance(a, motion, b);
    constexpr int STEPS = 60;
    double by_steps = std::numeric_limits<double>::infinity();
    for (int step = 0; step <= STEPS; ++step)
    {
      OrientedBox moved = a;
      moved.T_frame_box.pretranslate(motion * (static_cast<double>(step) / STEPS));
      by_steps = std::min(by_steps, clearance > 0 ? sampledDistance(moved, b, 10) : boxClearance(moved, b));
    }
    if (clearance > 0)
    {
      ++apart;
      // As above; a cell of the grid has a half diagonal of 0.014, half a step is at most 0.0043.
      EXPECT_GE(by_steps, clearance - 1e-12) << "pair " << i;
      EXPECT_LE(by_steps, std::sqrt(3.0) * clearance + 0.018) << "pair " << i;
    }
    else
    {
      ++overlapping;
      // The whole sweep overlaps at least as deep as any of its steps.
      EXPECT_LE(clearance, by_steps + 1e-12) << "pair " << i;
      EXPECT_LE(by_steps, 0.0043) << "pair " << i;
    }
  }
  EXPECT_GT(apart, 20);
  EXPECT_GT(overlapping, 20);
}
double reach(const std::vector<Vector3d>& points, const Vector3d& axis)
{
  double farthest = -std::numeric_limits<double>::infinity();
  for (const Vector3d& p : points)
    farthest = std::max(farthest, axis.dot(p));
  return farthest;
}

/// What must hold for any body: each plane supports it along a face, each corner lies on three planes, edges are told
/// once.
void expectConsistent(const ConvexBody& body)
{
  for (const Eigen::Vector4d& plane : body.planes)
  {
    EXPECT_NEAR(plane.head<3>().norm(), 1, 1e-9);
    EXPECT_NEAR(reach(body.vertices, plane.head<3>()), -plane.w(), 1e-8);
    EXPECT_GE(std::count_if(body.vertices.begin(), body.vertices.end(),
                            [&](const Vector3d& v) { return plane.head<3>().dot(v) + plane.w() > -1e-8; }),
              3);
  }
  for (const Vector3d& v : body.vertices)
    EXPECT_GE(std::count_if(body.planes.begin(), body.planes.end(),
                            [&](const Eigen::Vector4d& plane) { return plane.head<3>().dot(v) + plane.w() > -1e-8; }),
              3);
  for (std::size_t i = 0; i < body.edges.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_GT(body.edges[i].cross(body.edges[j]).norm(), 1e-9);
}

/// The body is the hull of the points: it reaches as far in every direction, by corners and by planes.
void expectHullOf(const ConvexBody& body, const std::vector<Vector3d>& points)
{
  expectConsistent(body);
  for (const Vector3d& axis : directions(500))
    EXPECT_NEAR(reach(body.vertices, axis), reach(points, axis), 1e-9);
  for (const Vector3d& p : points)
    EXPECT_LE(signedDistance(body, p), 1e-12);
  // Of a closed surface of that many faces, corners and edges (Euler): the triangles of its mesh.
  EXPECT_EQ(toMesh(body).triangles.size(), 2 * (body.vertices.size() - 2));
}

std::vector<Vector3d> boxGrid(int n)
{
  std::vector<Vector3d> points;
  for (int x = 0; x <= n; ++x)
    for (int y = 0; y <= n; ++y)
      for (int z = 0; z <= n; ++z)
        points.push_back(Vector3d(0.2 * x, 0.1 * y, 0.05 * z) / n);
  return points;
}

TEST(ConvexHull, OfAGridIsTheBoxWithSixFaces)
{
  // Most of the points lie within faces and edges.
  for (const int n : {1, 2, 7})
  {
    const Pose T = Eigen::Translation3d(0.3, -0.2, 0.7) * Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2).normalized();
    std::vector<Vector3d> points = boxGrid(n);
    for (Vector3d& p : points)
      p = T * p;
    const ConvexBody hull = makeHull(points);
    EXPECT_EQ(hull.vertices.size(), 8u);
    EXPECT_EQ(hull.planes.size(), 6u);
    EXPECT_EQ(hull.edges.size(), 3u);
    expectHullOf(hull, points);
  }
}

TEST(ConvexHull, OfACylinderHasItsFacets)
{
  std::vector<Vector3d> points;
  for (int i = 0; i < 48; ++i)
    for (const double z : {0.0, 0.01, 0.1})
      points.emplace_back(0.02 * std::cos(2 * M_PI * i / 48), 0.02 * std::sin(2 * M_PI * i / 48), z);
  const ConvexBody hull = makeHull(points);
  EXPECT_EQ(hull.vertices.size(), 96u);
  EXPECT_EQ(hull.planes.size(), 50u);
  EXPECT_EQ(hull.edges.size(), 25u);  // one along the axis, 48 / 2 round it
  expectHullOf(hull, points);
  // Single precision, as meshes come, changes none of it.
  for (Vector3d& p : points)
    p = p.cast<float>().cast<double>();
  EXPECT_EQ(makeHull(points).planes.size(), 50u);
}

TEST(ConvexHull, OfRandomPointsReachesAsFarAsThey)
{
  RandomBoxes random(6);
  for (int i = 0; i < 20; ++i)
  {
    std::vector<Vector3d> points;
    for (int k = 0; k < 4 + 10 * i; ++k)
      points.push_back(random.vector(-0.1, 0.1));
    expectHullOf(makeHull(points), points);
  }
}

TEST(ConvexHull, OfAFlatThingIsRefused)
{
  EXPECT_THROW(makeHull({}), ParameterError);
  EXPECT_THROW(makeHull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.3, 0.4, 0}}), ParameterError);
  EXPECT_THROW(makeHull(std::vector<Vector3d>(5, Vector3d(1, 2, 3))), ParameterError);
  EXPECT_THROW(makeHull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, std::nan("")}}), ParameterError);
  EXPECT_THROW(makeBox({0, 0, 0}, {1, 0, 1}), ParameterError);
}

TEST(Sweep, IsTheHullOfStartAndEnd)
{
  RandomBoxes random(7);
  for (int i = 0; i < 60; ++i)
  {
    std::vector<Vector3d> corners;
    for (int k = 0; k < 4 + i; ++k)
      corners.push_back(random.vector(-0.1, 0.1));
    const ConvexBody body = i % 2 ? bodyOf(random.box(0.1)) : makeHull(corners);
    // Along an edge, within a face, and any way.
    Vector3d motion = random.vector(-0.2, 0.2);
    if (i % 3 == 0)
      motion = 0.15 * body.edges[0];
    if (i % 3 == 1)
      motion = body.planes[0].head<3>().cross(motion);
    std::vector<Vector3d> covered = body.vertices;
    for (const Vector3d& v : body.vertices)
      covered.push_back(v + motion);
    expectHullOf(swept(body, motion), covered);
  }
}

TEST(Sweep, OfASweepIsAHullToo)
{
  const ConvexBody box = makeBox({0, 0, 0}, {0.02, 0.03, 0.04});
  const Vector3d first(0.1, 0.02, -0.03);
  const Vector3d second(-0.01, 0.07, 0.02);
  std::vector<Vector3d> covered;
  for (const Vector3d& v : box.vertices)
    for (const Vector3d& shift : {Vector3d(0, 0, 0), first, second, Vector3d(first + second)})
      covered.push_back(v + shift);
  expectHullOf(swept(swept(box, first), second), covered);
}

TEST(ConvexBodies, DistanceOfAPoint)
{
  const ConvexBody box = bodyOf(boxAt({0.1, 0, 0}, {0.05, 0.02, 0.01}));
  EXPECT_NEAR(signedDistance(box, {0.1, 0.005, 0}), -0.01, 1e-12);
  EXPECT_NEAR(signedDistance(box, {0.1, 0.05, 0}), 0.03, 1e-12);
  EXPECT_NEAR(signedDistance(box, {0.2, 0.05, 0}), 0.05, 1e-12);  // at an edge: a lower bound
}
}  // namespace
}  // namespace bin_picking
