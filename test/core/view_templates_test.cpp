// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "analytic_surfaces.hpp"
#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/view_templates.hpp"
#include "mesh_shapes.hpp"

namespace bin_picking
{
namespace
{
constexpr double RADIUS = 0.03;
constexpr double PIXEL = 0.0005;

TEST(ViewTemplates, sphereLooksTheSameFromEverywhere)
{
  const OrientedPoints surface = test::sphere(RADIUS, 3000);
  const auto views =
      renderViewTemplates(test::sphereMesh(static_cast<float>(RADIUS), 5), surface, PIXEL, 30, Executor(1));
  ASSERT_EQ(views.size(), 30u);
  for (const ViewTemplate& view : views)
  {
    // 11300 pixels: the counting error is that of some 10 pixels. Pixels count at their own depth, up to half a
    // diameter of 200 before the rim: 0.5 %, 0.3 % on average.
    EXPECT_NEAR(view.area / (M_PI * RADIUS * RADIUS), 1, 0.01);
    // The estimator of digitised lengths is right to 1 % on average over all directions, which a circle has.
    EXPECT_NEAR(view.contour / (2 * M_PI * RADIUS), 1, 0.02);
    std::vector<bool> visible(surface.size(), false);
    for (const std::uint32_t i : view.visible)
      visible[i] = true;
    for (std::size_t i = 0; i < surface.size(); ++i)
    {
      // The camera at 400 radii looks along directions that differ by up to 1 / 400 from the view's. What little a
      // facet lies above its neighbours is within the tolerance.
      const float cosine = surface.normals[i].dot(view.direction);
      if (cosine > 0.103f)
      {
        EXPECT_TRUE(visible[i]) << cosine;
      }
      if (cosine < 0.097f)
      {
        EXPECT_FALSE(visible[i]) << cosine;
      }
    }
  }
}

TEST(ViewTemplates, directionsAreEven)
{
  const auto views = renderViewTemplates(test::box(0.06f, 0.04f, 0.02f), {}, 0.002, 100, Executor(1));
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const auto& view : views)
  {
    EXPECT_NEAR(view.direction.norm(), 1, 1e-6);
    sum += view.direction;
    // 100 equal caps have a radius of 0.2 rad; the nearest neighbour of an even set is at 1.5 to 2 of it.
    float nearest = -1;
    for (const auto& other : views)
      if (&other != &view)
        nearest = std::max(nearest, view.direction.dot(other.direction));
    EXPECT_GT(std::acos(nearest), 0.25);
    EXPECT_LT(std::acos(nearest), 0.42);
  }
  EXPECT_LT(sum.norm() / 100, 0.01);
}

TEST(ViewTemplates, boxHasTheAreaOfItsProjection)
{
  const Eigen::Vector3d edges(0.06, 0.04, 0.02);
  const auto views = renderViewTemplates(test::box(0.06f, 0.04f, 0.02f), {}, 0.0004, 50, Executor(1));
  for (const ViewTemplate& view : views)
  {
    const Eigen::Vector3d d = view.direction.cast<double>().cwiseAbs();
    const double area = d.x() * edges.y() * edges.z() + d.y() * edges.x() * edges.z() + d.z() * edges.x() * edges.y();
    // Pixels along the contour: about 0.4 mm of it times half a pixel at random; the perspective adds up to 0.5 %.
    EXPECT_NEAR(view.area / area, 1, 0.01) << view.direction.transpose();
  }
}

TEST(ViewTemplates, seeWhatNothingHides)
{
  // A small box behind a large one, seen along the line of both, and from the side.
  TriangleMesh mesh = test::box(0.04f, 0.04f, 0.01f);
  const TriangleMesh small = test::box(0.01f, 0.01f, 0.01f);
  for (const auto& v : small.vertices)
    mesh.vertices.push_back(v - Eigen::Vector3f(0, 0, 0.05f));
  for (const auto& t : small.triangles)
    mesh.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  OrientedPoints surface;
  test::add(surface, {0, 0, 0.005}, {0, 0, 1});    // 0: on the large box
  test::add(surface, {0, 0, -0.045}, {0, 0, 1});   // 1: on the small one, facing the large one
  test::add(surface, {0, 0, -0.055}, {0, 0, -1});  // 2: on the small one, facing away
  test::add(surface, {0, 0, 0.002}, {0, 0, 1});    // 3: inside the large one
  const auto views = renderViewTemplates(mesh, surface, 0.0005, 200, Executor(1));
  for (const ViewTemplate& view : views)
  {
    const auto sees = [&](std::uint32_t i) {
      return std::find(view.visible.begin(), view.visible.end(), i) != view.visible.end();
    };
    const float z = view.direction.z();
    EXPECT_EQ(sees(0), z > 0.1f) << z;
    EXPECT_EQ(sees(2), z < -0.1f) << z;
    // The large box ends 20 mm beside the line and 40 mm above the point: it hides down to 26.6 degrees from the line,
    // 31.8 at its corners' inner edge at least in part.
    if (z > 0.93f || z < 0)
    {
      EXPECT_FALSE(sees(1)) << z;
    }
    if (z > 0.15f && z < 0.75f)
    {
      EXPECT_TRUE(sees(1)) << z;
    }
  }
  // Between 1.5 and 3 mm below the surface nothing is visible: the tolerance is 0.75 mm and the slant within a pixel.
  EXPECT_EQ(seenByAnyView(views, surface.size()), (std::vector<std::uint8_t>{1, 1, 1, 0}));
}

TEST(ViewTemplates, pointsWithoutTrianglesHideEachOther)
{
  const double spacing = 0.001;
  OrientedPoints surface =
      test::sphere(RADIUS, static_cast<std::size_t>(4 * M_PI * RADIUS * RADIUS / (spacing * spacing)));
  test::add(surface, {0, 0, 0}, {0, 0, 1});  // inside
  const auto views = renderViewTemplates({}, surface, spacing / 2, 20, Executor(1));
  for (const ViewTemplate& view : views)
  {
    // Discs of 1 mm are tangential: they reach 1 mm beyond the rim at most, 3 % of the radius, and 0.017 mm typically.
    EXPECT_NEAR(view.area / (M_PI * RADIUS * RADIUS), 1, 0.01);
    EXPECT_NEAR(static_cast<double>(view.visible.size()) / static_cast<double>(surface.size()), 0.45, 0.02);
  }
  EXPECT_EQ(seenByAnyView(views, surface.size()).back(), 0);
}

TEST(ViewTemplates, doNotDependOnThreads)
{
  const TriangleMesh mesh = test::box(0.06f, 0.04f, 0.02f);
  const OrientedPoints surface = sampleSurface(mesh, 0.002, 1);
  const auto one = renderViewTemplates(mesh, surface, 0.001, 40, Executor(1));
  const auto many = renderViewTemplates(mesh, surface, 0.001, 40, Executor(4));
  ASSERT_EQ(one.size(), many.size());
  for (std::size_t i = 0; i < one.size(); ++i)
  {
    EXPECT_EQ(one[i].area, many[i].area);
    EXPECT_EQ(one[i].contour, many[i].contour);
    EXPECT_EQ(one[i].visible, many[i].visible);
  }
}

TEST(ViewTemplates, refuseWhatCannotBeSeen)
{
  const TriangleMesh mesh = test::box(0.06f, 0.04f, 0.02f);
  EXPECT_THROW(renderViewTemplates(mesh, {}, 0.001, 0, Executor(1)), ParameterError);
  EXPECT_THROW(renderViewTemplates({}, {}, 0.001, 10, Executor(1)), ParameterError);
  EXPECT_THROW(renderViewTemplates(mesh, {}, 1e-7, 10, Executor(1)), ParameterError);
  EXPECT_THROW(renderViewTemplates(mesh, {}, 0.05, 10, Executor(1)), ParameterError);
  EXPECT_THROW(renderViewTemplates(mesh, {}, 0, 10, Executor(1)), ParameterError);
}

std::vector<std::uint8_t> maskOf(int side, const std::function<bool(double, double)>& inside)
{
  std::vector<std::uint8_t> mask;
  for (int v = 0; v < side; ++v)
    for (int u = 0; u < side; ++u)
      mask.push_back(inside(u - side / 2.0, v - side / 2.0) ? 255 : 0);
  return mask;
}

TEST(ContourLength, countsOuterContoursAndHoles)
{
  const auto ring = maskOf(200, [](double x, double y) { return std::hypot(x, y) < 80 && std::hypot(x, y) > 40; });
  EXPECT_NEAR(contourLength(ring, 200, 200) / (2 * M_PI * (80 + 40)), 1, 0.02);
  // 99 pixels wide. Along the grid the coefficients are 2 % short.
  const auto square = maskOf(200, [](double x, double y) { return std::abs(x) < 50 && std::abs(y) < 50; });
  EXPECT_NEAR(contourLength(square, 200, 200) / (4 * 99), 1, 0.03);
  const auto diamond = maskOf(200, [](double x, double y) { return std::abs(x) + std::abs(y) < 70; });
  EXPECT_NEAR(contourLength(diamond, 200, 200) / (4 * 70 * std::sqrt(2.0)), 1, 0.03);
  EXPECT_EQ(contourLength(std::vector<std::uint8_t>(12, 0), 4, 3), 0);
  EXPECT_THROW(contourLength(ring, 200, 100), ParameterError);
}
}  // namespace
}  // namespace bin_picking
