// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <cmath>

#include "analytic_surfaces.hpp"
#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/depth_renderer.hpp"
#include "mesh_shapes.hpp"

namespace bin_picking
{
namespace
{
const PinholeCamera CAMERA = {300, 310, 79.5, 60.25};
constexpr int WIDTH = 160;
constexpr int HEIGHT = 120;

/// A rectangle of the plane z = depth + slope * x, from low to high in x and y, as two triangles.
TriangleMesh rectangle(double depth, double slope, Eigen::Vector2d low, Eigen::Vector2d high)
{
  TriangleMesh mesh;
  for (const double y : {low.y(), high.y()})
    for (const double x : {low.x(), high.x()})
      mesh.vertices.push_back(Eigen::Vector3d(x, y, depth + slope * x).cast<float>());
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}};
  return mesh;
}

DepthRenderer render(const TriangleMesh& mesh, const Pose& T_camera_object = Pose::Identity())
{
  DepthRenderer image(WIDTH, HEIGHT, CAMERA);
  image.draw(mesh, T_camera_object, 5);
  return image;
}

TEST(DepthRenderer, slantedPlaneHasPerspectiveCorrectDepth)
{
  // Larger than the view, so that every pixel is hit and clipping at the image border is exercised.
  const DepthRenderer image = render(rectangle(0.8, 0.6, {-1, -1}, {1, 1}));
  for (int v = 0; v < HEIGHT; ++v)
    for (int u = 0; u < WIDTH; ++u)
    {
      // z = 0.8 + 0.6 x on the ray x = (u - cx) / fx z
      const double exact = 0.8 / (1 - 0.6 * (u - CAMERA.cx) / CAMERA.fx);
      const auto i = static_cast<std::size_t>(v * WIDTH + u);
      EXPECT_NEAR(static_cast<double>(image.depth()[i]), exact, 3e-7);  // single precision of corners and depth
      EXPECT_EQ(image.labels()[i], 5);
    }
}

TEST(DepthRenderer, coversExactlyThePixelCentersInside)
{
  // Edges at u = 29.5 + 1/4 ... 90.25 and v = 20.6 ... 70.4: pixels 30..90 and 21..70.
  const double z = 0.5;
  const Eigen::Vector3d low = CAMERA.backProject(29.75, 20.6, z);
  const Eigen::Vector3d high = CAMERA.backProject(90.25, 70.4, z);
  const DepthRenderer image = render(rectangle(z, 0, low.head<2>(), high.head<2>()));
  for (int v = 0; v < HEIGHT; ++v)
    for (int u = 0; u < WIDTH; ++u)
    {
      const bool inside = u >= 30 && u <= 90 && v >= 21 && v <= 70;
      const auto i = static_cast<std::size_t>(v * WIDTH + u);
      EXPECT_EQ(std::isfinite(image.depth()[i]), inside) << u << ", " << v;
      EXPECT_EQ(image.labels()[i], inside ? 5 : -1);
    }
}

TEST(DepthRenderer, sphereHasAnalyticDepth)
{
  const double radius = 0.08;
  const Eigen::Vector3d center(0.02, -0.01, 0.6);
  Pose T_camera_object = Pose::Identity();
  T_camera_object.translation() = center;
  const DepthGrid grid = render(test::sphereMesh(static_cast<float>(radius), 6), T_camera_object).grid();
  int compared = 0;
  for (int v = 0; v < HEIGHT; ++v)
    for (int u = 0; u < WIDTH; ++u)
    {
      const Eigen::Vector3d ray = CAMERA.backProject(u, v, 1).normalized();
      const double along = ray.dot(center);
      const double miss_squared = center.squaredNorm() - along * along;
      const double share = std::sqrt(miss_squared) / radius;
      const int i = grid.index(u, v);
      // Triangles with edges of up to 2.9 mm lie up to 17.5 um below the sphere; where the ray slants by share = 0.95
      // it meets them 1 / 0.31 times that further on.
      if (share < 0.95)
      {
        const Eigen::Vector3d hit = ray * (along - std::sqrt(radius * radius - miss_squared));
        EXPECT_NEAR((grid.point(i).cast<double>() - hit).norm(), 0, 6e-5) << u << ", " << v;
        ++compared;
      }
      if (share > 1.0001)
      {
        EXPECT_FALSE(grid.valid(i)) << u << ", " << v;
      }
      else if (share < 0.999)
      {
        EXPECT_TRUE(grid.valid(i)) << u << ", " << v;
      }
    }
  EXPECT_GT(compared, 4000);
}

TEST(DepthRenderer, closedSurfacesHaveNoGaps)
{
  // Thousands of shared edges in all directions: every pixel well within the silhouette must be hit, and none with the
  // depth of the far side, which a gap would let through.
  Pose T_camera_object(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()));
  T_camera_object.translation() = Eigen::Vector3d(0, 0, 0.6);
  const DepthRenderer image = render(test::sphereMesh(0.08f, 5), T_camera_object);
  for (int v = 0; v < HEIGHT; ++v)
    for (int u = 0; u < WIDTH; ++u)
      if (std::hypot(u - CAMERA.cx, v - CAMERA.cy) < 36)
      {
        EXPECT_LT(image.depth()[static_cast<std::size_t>(v * WIDTH + u)], 0.6f);
      }
}

TEST(DepthRenderer, nearestSurfaceWinsInAnyOrder)
{
  const TriangleMesh near = rectangle(0.5, 0, {-0.05, -0.05}, {0.05, 0.05});
  const TriangleMesh far = rectangle(0.7, 0, {-0.2, -0.2}, {0.2, 0.2});
  DepthRenderer near_first(WIDTH, HEIGHT, CAMERA);
  near_first.draw(near, Pose::Identity(), 1);
  near_first.draw(far, Pose::Identity(), 2);
  DepthRenderer far_first(WIDTH, HEIGHT, CAMERA);
  far_first.draw(far, Pose::Identity(), 2);
  far_first.draw(near, Pose::Identity(), 1);
  EXPECT_EQ(near_first.depth(), far_first.depth());
  EXPECT_EQ(near_first.labels(), far_first.labels());
  EXPECT_EQ(near_first.labels()[60 * WIDTH + 80], 1);
  EXPECT_EQ(near_first.labels()[60 * WIDTH + 20], 2);
}

TEST(DepthRenderer, bothSidesOfATriangleHide)
{
  TriangleMesh sheet = rectangle(0.5, 0, {-0.05, -0.05}, {0.05, 0.05});
  const DepthRenderer front = render(sheet);
  for (auto& t : sheet.triangles)
    std::swap(t[0], t[1]);
  EXPECT_EQ(front.depth(), render(sheet).depth());
}

TEST(DepthRenderer, leavesOutWhatReachesBehindTheCamera)
{
  const DepthRenderer image = render(rectangle(0.05, 1, {-0.2, -0.1}, {0.2, 0.1}));
  for (const float depth : image.depth())
    EXPECT_TRUE(std::isinf(depth));
  const DepthGrid grid = image.grid();
  EXPECT_FALSE(grid.valid(grid.index(80, 60)));
  EXPECT_TRUE(std::isnan(grid.x[0]) && std::isnan(grid.y[0]));
}

TEST(DepthRenderer, ignoresWhatIsNotFinite)
{
  TriangleMesh broken = rectangle(0.5, 0, {-0.05, -0.05}, {0.05, 0.05});
  broken.vertices[1].x() = std::nanf("");
  OrientedPoints points;
  points.points = {{std::nanf(""), 0, 0.5f}};
  points.normals = {{0, 0, -1}};
  DepthRenderer image = render(broken);
  image.draw(points, Pose::Identity(), 0.01, 1);
  for (const float depth : image.depth())
    EXPECT_TRUE(std::isinf(depth));
}

TEST(DepthRenderer, discIsItsEllipse)
{
  // A disc of 30 mm tilted by 60 degrees: inside where the point of its plane on the ray is nearer than the radius.
  OrientedPoints disc;
  disc.points = {{0.01f, 0.02f, 0.5f}};
  disc.normals = {{static_cast<float>(std::sin(M_PI / 3)), 0, -0.5f}};
  DepthRenderer image(WIDTH, HEIGHT, CAMERA);
  image.draw(disc, Pose::Identity(), 0.03, 7);
  const Eigen::Vector3d center = disc.points[0].cast<double>();
  const Eigen::Vector3d normal = disc.normals[0].cast<double>();
  int inside = 0;
  for (int v = 0; v < HEIGHT; ++v)
    for (int u = 0; u < WIDTH; ++u)
    {
      const Eigen::Vector3d ray = CAMERA.backProject(u, v, 1);
      const Eigen::Vector3d hit = ray * normal.dot(center) / normal.dot(ray);
      const double distance = (hit - center).norm();
      const auto i = static_cast<std::size_t>(v * WIDTH + u);
      if (distance < 0.03 - 1e-6)
      {
        EXPECT_NEAR(static_cast<double>(image.depth()[i]), hit.z(), 1e-6);
        EXPECT_EQ(image.labels()[i], 7);
        ++inside;
      }
      else if (distance > 0.03 + 1e-6)
      {
        EXPECT_TRUE(std::isinf(image.depth()[i]));
      }
    }
  // pi r^2 cos(60 deg) in pixels, up to the pixels along its contour.
  EXPECT_NEAR(inside, M_PI * 0.03 * 0.03 * 0.5 * CAMERA.fx * CAMERA.fy / 0.25, 25);
}

TEST(DepthRenderer, gridHoldsThePointsOnTheRays)
{
  const DepthGrid grid = render(rectangle(0.8, 0.6, {-1, -1}, {1, 1})).grid();
  ASSERT_EQ(grid.width, WIDTH);
  ASSERT_EQ(grid.height, HEIGHT);
  const Eigen::Vector3d p = grid.point(grid.index(30, 100)).cast<double>();
  EXPECT_LT((CAMERA.project(p) - Eigen::Vector2d(30, 100)).norm(), 1e-4);
  EXPECT_NEAR(p.z(), 0.8 + 0.6 * p.x(), 1e-6);
}

TEST(DepthRenderer, refusesImpossibleCameras)
{
  EXPECT_THROW(DepthRenderer(0, 10, CAMERA), ParameterError);
  EXPECT_THROW(DepthRenderer(10, 1 << 20, CAMERA), ParameterError);
  EXPECT_THROW(DepthRenderer(10, 10, PinholeCamera{0, 300, 5, 5}), ParameterError);
  EXPECT_THROW(DepthRenderer(10, 10, PinholeCamera{300, 300, std::nan(""), 5}), ParameterError);
}
}  // namespace
}  // namespace bin_picking
