// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/depth_renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
/// Nothing nearer than this is drawn, metres: a triangle that reaches behind the camera has no projection.
constexpr double NEAR_PLANE = 1e-3;
/// Pixel centres this close to an edge, in pixels, count as inside, so that rounding leaves no gap between neighbours.
constexpr double EDGE_TOLERANCE = 1e-6;

/// The buffers that are drawn into.
struct Target
{
  int width;
  int height;
  float* depth;
  std::int32_t* labels;

  void put(int u, int v, double z, std::int32_t label) const
  {
    const std::size_t i = static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u);
    const auto near = static_cast<float>(z);
    if (near < depth[i])
    {
      depth[i] = near;
      labels[i] = label;
    }
  }
};

/// First and last whole number of [low, high] within [0, size).
struct PixelRange
{
  int first;
  int last;

  PixelRange(double low, double high, int size)
      : first(static_cast<int>(std::ceil(std::clamp(low - EDGE_TOLERANCE, 0.0, static_cast<double>(size))))),
        last(static_cast<int>(std::floor(std::clamp(high + EDGE_TOLERANCE, -1.0, size - 1.0))))
  {}
};

/// Bounds u on one side of an edge of a projected triangle. An edge along a row bounds nothing: the rows are bounded.
struct EdgeBound
{
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  double slope = 0;  ///< pixels of u per row
  int side = 0;      ///< +1: lower bound, -1: upper bound, 0: none
};

EdgeBound edgeBound(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double orientation)
{
  const double dv = to.y() - from.y();
  if (dv == 0)
    return {};
  return {from, (to.x() - from.x()) / dv, (dv > 0) == (orientation > 0) ? -1 : 1};
}

/// 1 / z is linear in the pixel coordinates: of the plane through three points n . p = d, 1 / z = n . ray / d.
struct InverseDepth
{
  double per_u;
  double per_v;
  double constant;

  InverseDepth(const Eigen::Vector3d& n, double d, const PinholeCamera& camera)
      : per_u(n.x() / (camera.fx * d)),
        per_v(n.y() / (camera.fy * d)),
        constant(n.z() / d - per_u * camera.cx - per_v * camera.cy)
  {}
};

/// First and last column of a row that lie in the triangle.
PixelRange columnsOfRow(const std::array<Eigen::Vector2d, 3>& q, const std::array<EdgeBound, 3>& bounds, int v,
                        int width)
{
  double low = std::min({q[0].x(), q[1].x(), q[2].x()});
  double high = std::max({q[0].x(), q[1].x(), q[2].x()});
  for (const EdgeBound& bound : bounds)
  {
    const double u = bound.from.x() + bound.slope * (v - bound.from.y());
    low = bound.side > 0 ? std::max(low, u) : low;
    high = bound.side < 0 ? std::min(high, u) : high;
  }
  return {low, high, width};
}

void fillTriangle(const Target& target, const PinholeCamera& camera, const std::array<Eigen::Vector3d, 3>& p,
                  const std::array<Eigen::Vector2d, 3>& q, std::int32_t label)
{
  const Eigen::Vector2d e1 = q[1] - q[0];
  const Eigen::Vector2d e2 = q[2] - q[0];
  const double orientation = e1.x() * e2.y() - e1.y() * e2.x();
  const Eigen::Vector3d normal = (p[1] - p[0]).cross(p[2] - p[0]);
  const double distance = normal.dot(p[0]);
  if (!(std::abs(orientation) > 0 && std::abs(distance) > 0))
    return;  // seen exactly edge-on, or not finite
  const std::array<EdgeBound, 3> bounds = {edgeBound(q[0], q[1], orientation), edgeBound(q[1], q[2], orientation),
                                           edgeBound(q[2], q[0], orientation)};
  const InverseDepth inverse(normal, distance, camera);
  // A pixel centre that only the tolerance lets in must not get a depth from far outside a grazing triangle.
  const double nearest = std::min({p[0].z(), p[1].z(), p[2].z()});
  const double farthest = std::max({p[0].z(), p[1].z(), p[2].z()});
  const PixelRange rows(std::min({q[0].y(), q[1].y(), q[2].y()}), std::max({q[0].y(), q[1].y(), q[2].y()}),
                        target.height);
  for (int v = rows.first; v <= rows.last; ++v)
  {
    const PixelRange columns = columnsOfRow(q, bounds, v, target.width);
    const double row_inverse = inverse.constant + inverse.per_v * v;
    for (int u = columns.first; u <= columns.last; ++u)
      target.put(u, v, std::clamp(1 / (row_inverse + inverse.per_u * u), nearest, farthest), label);
  }
}

void fillDisc(const Target& target, const PinholeCamera& camera, const Eigen::Vector3d& p,
              const Eigen::Vector3d& normal, double radius, std::int32_t label)
{
  const double front = p.z() - radius;
  if (!(front > NEAR_PLANE) || !p.allFinite())
    return;
  const Eigen::Vector2d center = camera.project(p);
  // Generous: the projection of the ball around the disc, taken at its front and widened by its slant.
  const double widening = 1 + std::hypot(p.x(), p.y()) / p.z();
  const double reach_u = camera.fx * radius / front * widening;
  const double reach_v = camera.fy * radius / front * widening;
  const PixelRange columns(center.x() - reach_u, center.x() + reach_u, target.width);
  const PixelRange rows(center.y() - reach_v, center.y() + reach_v, target.height);
  const double distance = normal.dot(p);
  for (int v = rows.first; v <= rows.last; ++v)
    for (int u = columns.first; u <= columns.last; ++u)
    {
      const Eigen::Vector3d ray = camera.backProject(u, v, 1);
      const double z = distance / normal.dot(ray);
      // Also false for a ray along the disc, where z is infinite or not a number.
      if ((ray * z - p).squaredNorm() <= radius * radius)
        target.put(u, v, z, label);
    }
}
}  // namespace

DepthRenderer::DepthRenderer(int width, int height, const PinholeCamera& camera)
    : width_(width), height_(height), camera_(camera)
{
  constexpr int MAX_SIDE = 1 << 14;
  if (width < 1 || height < 1 || width > MAX_SIDE || height > MAX_SIDE)
    throw ParameterError("a rendered image of " + std::to_string(width) + " x " + std::to_string(height) +
                         " pixels was asked for, but each side must lie in [1, " + std::to_string(MAX_SIDE) + "]");
  if (!(camera.fx > 0 && camera.fy > 0 && std::isfinite(camera.fx + camera.fy + camera.cx + camera.cy)))
    throw ParameterError("the focal lengths of the rendering camera are " + std::to_string(camera.fx) + " and " +
                         std::to_string(camera.fy) + ", but they must be positive and all intrinsics finite");
  const std::size_t size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  depth_.assign(size, std::numeric_limits<float>::infinity());
  labels_.assign(size, -1);
}

void DepthRenderer::draw(const TriangleMesh& mesh, const Pose& T_camera_object, std::int32_t label)
{
  std::vector<Eigen::Vector3d> points_camera;
  std::vector<Eigen::Vector2d> pixels;
  points_camera.reserve(mesh.vertices.size());
  pixels.reserve(mesh.vertices.size());
  for (const auto& vertex : mesh.vertices)
  {
    points_camera.push_back(T_camera_object * vertex.cast<double>());
    pixels.push_back(camera_.project(points_camera.back()));
  }
  const Target target{width_, height_, depth_.data(), labels_.data()};
  for (const auto& t : mesh.triangles)
  {
    const std::array<Eigen::Vector3d, 3> p = {points_camera[t[0]], points_camera[t[1]], points_camera[t[2]]};
    if (p[0].z() > NEAR_PLANE && p[1].z() > NEAR_PLANE && p[2].z() > NEAR_PLANE)
      fillTriangle(target, camera_, p, {pixels[t[0]], pixels[t[1]], pixels[t[2]]}, label);
  }
}

void DepthRenderer::draw(const OrientedPoints& points, const Pose& T_camera_object, double radius, std::int32_t label)
{
  const Target target{width_, height_, depth_.data(), labels_.data()};
  for (std::size_t i = 0; i < points.size(); ++i)
    fillDisc(target, camera_, T_camera_object * points.points[i].cast<double>(),
             T_camera_object.linear() * points.normals[i].cast<double>(), radius, label);
}

DepthGrid DepthRenderer::grid() const
{
  DepthGrid grid = makeGrid(width_, height_, camera_);
  for (int v = 0; v < height_; ++v)
    for (int u = 0; u < width_; ++u)
    {
      const auto i = static_cast<std::size_t>(grid.index(u, v));
      if (std::isinf(depth_[i]))
        continue;
      const Eigen::Vector3d p = camera_.backProject(u, v, static_cast<double>(depth_[i]));
      grid.x[i] = static_cast<float>(p.x());
      grid.y[i] = static_cast<float>(p.y());
      grid.z[i] = depth_[i];
    }
  return grid;
}
}  // namespace bin_picking
