// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// The bodies with which the physics works: they must cover the part and fill hardly anything else.
#include "convex_pieces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "bin_picking_perception/model/part.hpp"
#include "convex_hull.hpp"
#include "core/mesh_shapes.hpp"
#include "core/surface_distance.hpp"
#include "mesh_solid.hpp"
#include "voxel_solid.hpp"

using namespace bin_picking;
using namespace bin_picking::simulation;
using namespace bin_picking::test;

namespace
{
class Points
{
public:
  explicit Points(const TriangleMesh& mesh, std::uint32_t seed = 3) : engine_(seed)
  {
    for (const Eigen::Vector3f& p : mesh.vertices)
      box_.extend(p.cast<double>());
  }

  const Eigen::AlignedBox3d& box() const { return box_; }
  /// Somewhere in the bounding box.
  Eigen::Vector3d next()
  {
    Eigen::Vector3d p;
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = box_.min()[axis] + box_.sizes()[axis] * static_cast<double>(engine_()) / 4294967296.0;
    return p;
  }

private:
  std::mt19937 engine_;
  Eigen::AlignedBox3d box_;
};

std::vector<ConvexHull> hullsOf(const std::vector<ConvexPiece>& pieces)
{
  std::vector<ConvexHull> hulls;
  for (const ConvexPiece& piece : pieces)
  {
    std::vector<Eigen::Vector3d> corners;
    for (const Eigen::Vector3f& corner : piece)
      corners.push_back(corner.cast<double>());
    hulls.push_back(convexHull(corners));
  }
  return hulls;
}

/// How far a point sticks out of the body, metres; negative: inside.
double heightAbove(const ConvexHull& hull, const Eigen::Vector3d& p)
{
  double height = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector4d& plane : hull.planes)
    height = std::max(height, plane.head<3>().dot(p) + plane.w());
  return height;
}

double heightAbove(const std::vector<ConvexHull>& hulls, const Eigen::Vector3d& p)
{
  double height = std::numeric_limits<double>::infinity();
  for (const ConvexHull& hull : hulls)
    height = std::min(height, heightAbove(hull, p));
  return height;
}

/// Hulls are computed on a grid of a ten-thousandth of the part; a few joins add up.
constexpr double HULL_ROUNDING = 3e-4;  // of the diameter

class DemoPart : public ::testing::TestWithParam<const char*>
{
protected:
  void SetUp() override
  {
    const PartDefinition part = loadPart(std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/" + GetParam());
    mesh_ = loadMesh(part.mesh_file, part.mesh_unit);
    diameter_ = largestDistance(mesh_.vertices);
    hulls_ = hullsOf(convexPieces(mesh_));
  }

  TriangleMesh mesh_;
  double diameter_ = 0;
  std::vector<ConvexHull> hulls_;
};
}  // namespace

TEST_P(DemoPart, isCoveredByItsPieces)
{
  double farthest = 0;
  for (const Eigen::Vector3f& p : sampleSurface(mesh_, 0.002, 5).points)
    farthest = std::max(farthest, heightAbove(hulls_, p.cast<double>()));
  EXPECT_LT(farthest, HULL_ROUNDING * diameter_);
  const SolidTest inside(mesh_);
  Points points(mesh_);
  int num_inside = 0;
  for (int k = 0; k < 10000; ++k)
  {
    const Eigen::Vector3d p = points.next();
    if (!inside(p))
      continue;
    ++num_inside;
    ASSERT_LT(heightAbove(hulls_, p), HULL_ROUNDING * diameter_) << p.transpose();
  }
  EXPECT_GT(num_inside, 300);
}

TEST_P(DemoPart, isNotFilledDeeperThanPromised)
{
  const SolidTest inside(mesh_);
  Points points(mesh_);
  // Filling is measured at the centres of cubes of 1/64 of the longest edge: in between by half a diagonal more.
  const double promised = ConvexPiecesParameters{}.max_filling * diameter_;
  const double between = std::sqrt(3.0) / 2 * points.box().sizes().maxCoeff() / 64;
  for (int k = 0; k < 10000; ++k)
  {
    const Eigen::Vector3d p = points.next();
    if (heightAbove(hulls_, p) > 0 || inside(p))
      continue;
    ASSERT_LT(largestSurfaceDistance({p.cast<float>()}, mesh_), promised + between) << p.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(ConvexPieces, DemoPart,
                         ::testing::Values("cast_handle", "hex_bolt", "l_bracket", "pipe_elbow", "stepped_shaft",
                                           "three_way_tube", "upright_column"));

TEST(ConvexPieces, convexBodyIsOnePiece)
{
  const std::vector<ConvexPiece> pieces = convexPieces(box(0.08f, 0.04f, 0.02f));
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_NEAR(hullsOf(pieces)[0].volume, 64e-6, 64e-6 * 0.001);
  EXPECT_EQ(convexPieces(sphereMesh(0.02f, 2)).size(), 1u);
}

TEST(ConvexPieces, ringKeepsItsHole)
{
  const std::vector<ConvexHull> hulls = hullsOf(convexPieces(tubeMesh(0.04f, 0.03f, 0.02f, 48)));
  EXPECT_GE(hulls.size(), 6u);
  // A stick along the bore: within 2 % of the diameter (and a cube) of the wall it may touch.
  for (double z = -0.01; z < 0.03; z += 0.0005)
    for (double angle = 0; angle < 2 * M_PI; angle += 0.1)
      for (const double radius : {0.0, 0.01, 0.026})
        ASSERT_GT(heightAbove(hulls, {radius * std::cos(angle), radius * std::sin(angle), z}), 0);
}

TEST(ConvexPieces, angleKeepsItsCornerFree)
{
  const std::vector<ConvexPiece> pieces = convexPieces(angleMesh(0.08f, 0.01f, 0.05f));
  EXPECT_EQ(pieces.size(), 2u) << "two plates";
  const std::vector<ConvexHull> hulls = hullsOf(pieces);
  const double free = 0.01 + 0.02 * std::hypot(0.08, 0.08, 0.05) + 0.08 / 64;
  for (double x = free; x < 0.08; x += 0.002)
    for (double y = free; y < 0.08; y += 0.002)
      ASSERT_GT(heightAbove(hulls, {x, y, 0.025}), 0) << x << " " << y;
}

TEST(ConvexHull, boxHasSixPlanesAndItsVolume)
{
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3f& p : box(0.08f, 0.04f, 0.02f).vertices)
    points.push_back(p.cast<double>());
  points.insert(points.end(), {{0, 0, 0}, {0.01, 0.005, 0.01}, {0.04, 0.01, 0.002}});  // within, on a face
  const ConvexHull hull = convexHull(points);
  EXPECT_EQ(hull.vertices.size(), 8u);
  EXPECT_NEAR(hull.volume, 64e-6, 64e-6 * 1e-3);
  EXPECT_TRUE(hull.contains({0.0399, 0.0199, 0.0099}));
  EXPECT_FALSE(hull.contains({0.0401, 0, 0}));
  EXPECT_FALSE(hull.contains({0, 0, -0.0101}));
}

TEST(ConvexHull, shrunkBoxIsSmallerOnEverySide)
{
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3f& p : box(0.08f, 0.04f, 0.02f).vertices)
    points.push_back(p.cast<double>());
  // 0.008 mm of rounding on every side.
  EXPECT_NEAR(convexHull(points, 0.001).volume, 0.078 * 0.038 * 0.018, 5e-8);
}

TEST(ConvexHull, pointsInAPlaneHaveNoHull)
{
  const std::vector<Eigen::Vector3d> flat = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0.1, 0.1, 0}, {0.05, 0.02, 0}};
  EXPECT_TRUE(convexHull(flat).vertices.empty());
  EXPECT_TRUE(convexHull({}).vertices.empty());
}

TEST(ConvexHull, simplifiedHullLeavesOutNoMoreThanItMay)
{
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3f& p : sphereMesh(0.02f, 4).vertices)
    points.push_back(p.cast<double>());
  std::size_t num_before = points.size() + 1;
  for (const double tolerance : {0.0001, 0.0003, 0.001})
  {
    const std::vector<Eigen::Vector3d> kept = simplifiedHull(points, tolerance);
    EXPECT_LT(kept.size(), num_before) << "the more may be missing, the fewer corners";
    num_before = kept.size();
    const ConvexHull hull = convexHull(kept);
    for (const Eigen::Vector3d& p : points)
      ASSERT_LT(heightAbove(hull, p), tolerance + HULL_ROUNDING * 0.04);
  }
}

TEST(SolidTest, tellsInsideFromOutsideOfABox)
{
  const Eigen::Vector3d half(0.04, 0.02, 0.01);
  const TriangleMesh mesh = box(0.08f, 0.04f, 0.02f);
  const SolidTest inside(mesh);
  std::mt19937 engine(1);
  for (int k = 0; k < 20000; ++k)
  {
    Eigen::Vector3d p;
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = 1.5 * half[axis] * (static_cast<double>(engine()) / 2147483648.0 - 1);
    ASSERT_EQ(inside(p), (p.cwiseAbs().array() < half.array()).all()) << p.transpose();
  }
  // Lines through edges and corners of the mesh, where a crossing could be counted twice.
  EXPECT_TRUE(inside({0, 0, 0}));
  EXPECT_FALSE(inside({-0.05, 0.02, 0.01}));
  EXPECT_FALSE(inside({-0.05, 0, 0}));
  EXPECT_FALSE(inside({0, 0, 0.011}));
}

TEST(SolidTest, tellsInsideFromOutsideOfASphere)
{
  const TriangleMesh mesh = sphereMesh(0.03f, 4);
  const SolidTest inside(mesh);
  double inner = 1;  // the nearest facet
  for (const auto& t : mesh.triangles)
    inner = std::min(
        inner, static_cast<double>(((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3).norm()));
  Points points(mesh);
  for (int k = 0; k < 20000; ++k)
  {
    const Eigen::Vector3d p = points.next();
    if (p.norm() > inner - 1e-6 && p.norm() < 0.03 + 1e-6)
      continue;  // between facet and sphere
    ASSERT_EQ(inside(p), p.norm() < 0.03) << p.transpose();
  }
}

TEST(VoxelSolid, distancesAreThoseOfTheNearestCubeInside)
{
  constexpr double LEG = 0.08;
  constexpr double THICKNESS = 0.013;
  const VoxelSolid solid(angleMesh(static_cast<float>(LEG), static_cast<float>(THICKNESS), 0.03f), 20);
  EXPECT_NEAR(solid.edge(), LEG / 20, 1e-8);
  std::vector<Eigen::Vector3i> all;
  std::vector<Eigen::Vector3i> inside;
  for (int z = 0; z < solid.size().z(); ++z)
    for (int y = 0; y < solid.size().y(); ++y)
      for (int x = 0; x < solid.size().x(); ++x)
      {
        const Eigen::Vector3i cube(x, y, z);
        const Eigen::Vector3d p = solid.center(cube);
        ASSERT_EQ(solid.inside(cube), p.z() > 0 && p.z() < 0.03 && std::min(p.x(), p.y()) < THICKNESS) << p.transpose();
        all.push_back(cube);
        if (solid.inside(cube))
          inside.push_back(cube);
      }
  ASSERT_GT(inside.size(), 500u);
  for (const Eigen::Vector3i& cube : all)
  {
    int nearest = std::numeric_limits<int>::max();
    for (const Eigen::Vector3i& other : inside)
      nearest = std::min(nearest, (cube - other).squaredNorm());
    ASSERT_NEAR(solid.distance(cube), solid.edge() * std::sqrt(nearest), 1e-8) << cube.transpose();
  }
}
