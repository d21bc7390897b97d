// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/convex_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
using Eigen::Vector3d;
using Eigen::Vector4d;

// Directions closer to parallel than this have no usable cross product. Any unit axis yields a true lower bound, so
// that an inaccurate one does no harm; only a vanishing one has to be skipped.
constexpr double MIN_CROSS_PRODUCT = 1e-9;

// Corners this close to a supporting plane lie on it, metres: rounding, far below anything that a gripper could feel.
constexpr double ON_PLANE = 1e-9;

/// The farthest that a body reaches along an axis.
double reach(const std::vector<Vector3d>& vertices, const Vector3d& axis)
{
  double farthest = -std::numeric_limits<double>::infinity();
  for (const Vector3d& v : vertices)
    farthest = std::max(farthest, axis.dot(v));
  return farthest;
}

/// How far a body reaches along an axis to either side.
struct Extent
{
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  Extent(const std::vector<Vector3d>& vertices, const Vector3d& axis)
  {
    for (const Vector3d& v : vertices)
    {
      const double along = axis.dot(v);
      low = std::min(low, along);
      high = std::max(high, along);
    }
  }
};

bool isAmong(const std::vector<Vector4d>& planes, const Vector3d& normal)
{
  return std::any_of(planes.begin(), planes.end(), [&](const Vector4d& plane) {
    return plane.head<3>().dot(normal) > 0 && plane.head<3>().cross(normal).norm() < MIN_CROSS_PRODUCT;
  });
}

/// Whether the outermost corners along the axis span an edge that the motion does not only move along itself.
bool sweepsAFace(const std::vector<Vector3d>& vertices, const Vector3d& axis, double farthest,
                 const Vector3d& direction)
{
  const Vector3d* first = nullptr;
  for (const Vector3d& v : vertices)
  {
    if (axis.dot(v) < farthest - ON_PLANE)
      continue;
    if (first && (v - *first).cross(direction).norm() > ON_PLANE)
      return true;
    first = first ? first : &v;
  }
  return false;
}

/// The corners that remain corners of the sweep: at the start those of a face that looks back, at the end those of one
/// that looks ahead.
std::vector<Vector3d> sweptVertices(const ConvexBody& body, const Vector3d& motion)
{
  const Vector3d direction = motion.normalized();
  std::vector<Vector3d> vertices;
  vertices.reserve(2 * body.vertices.size());
  for (const Vector3d& v : body.vertices)
  {
    bool looks_back = false;
    bool looks_ahead = false;
    for (const Vector4d& plane : body.planes)
      if (plane.head<3>().dot(v) + plane.w() > -ON_PLANE)
      {
        looks_back = looks_back || plane.head<3>().dot(direction) < -MIN_CROSS_PRODUCT;
        looks_ahead = looks_ahead || plane.head<3>().dot(direction) > MIN_CROSS_PRODUCT;
      }
    if (looks_back || !looks_ahead)
      vertices.push_back(v);
    if (looks_ahead || !looks_back)
      vertices.push_back(v + motion);
  }
  return vertices;
}

std::vector<std::uint32_t> cornersOfFace(const ConvexBody& body, const Vector4d& plane)
{
  std::vector<std::uint32_t> corners;
  Vector3d middle = Vector3d::Zero();
  for (std::size_t i = 0; i < body.vertices.size(); ++i)
    if (plane.head<3>().dot(body.vertices[i]) + plane.w() > -1e-7)
    {
      corners.push_back(static_cast<std::uint32_t>(i));
      middle += body.vertices[i];
    }
  if (corners.size() < 3)
    return {};
  middle /= static_cast<double>(corners.size());
  const Vector3d x = (body.vertices[corners[0]] - middle).normalized();
  const Vector3d y = plane.head<3>().cross(x);
  const auto angle = [&](std::uint32_t i) {
    return std::atan2(y.dot(body.vertices[i] - middle), x.dot(body.vertices[i] - middle));
  };
  std::sort(corners.begin(), corners.end(), [&](std::uint32_t a, std::uint32_t b) { return angle(a) < angle(b); });
  return corners;
}
}  // namespace

ConvexBody makeBox(const Vector3d& center, const Vector3d& size)
{
  if (!(size.minCoeff() > 0))
    throw ParameterError("A box of " + std::to_string(size.x()) + " x " + std::to_string(size.y()) + " x " +
                         std::to_string(size.z()) + " m has no volume; each edge must be longer than 0.");
  ConvexBody box;
  for (int corner = 0; corner < 8; ++corner)
    box.vertices.push_back(
        center + 0.5 * size.cwiseProduct(Vector3d(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1)));
  for (int axis = 0; axis < 3; ++axis)
  {
    const Vector3d normal = Vector3d::Unit(axis);
    box.planes.emplace_back(normal.x(), normal.y(), normal.z(), -center[axis] - 0.5 * size[axis]);
    box.planes.emplace_back(-normal.x(), -normal.y(), -normal.z(), center[axis] - 0.5 * size[axis]);
    box.edges.push_back(normal);
  }
  return box;
}

ConvexBody transformed(const ConvexBody& body, const Pose& T)
{
  ConvexBody moved = body;
  for (Vector3d& v : moved.vertices)
    v = T * v;
  for (Vector4d& plane : moved.planes)
  {
    const Vector3d normal = T.linear() * plane.head<3>();
    plane << normal, plane.w() - normal.dot(T.translation());
  }
  for (Vector3d& edge : moved.edges)
    edge = T.linear() * edge;
  return moved;
}

ConvexBody swept(const ConvexBody& body, const Vector3d& motion)
{
  const double length = motion.norm();
  if (!(length > ON_PLANE))
    return body;
  ConvexBody sweep;
  sweep.vertices = sweptVertices(body, motion);
  sweep.planes.reserve(body.planes.size() + 2 * body.edges.size());
  sweep.planes = body.planes;
  for (Vector4d& plane : sweep.planes)
    plane.w() -= std::max(0.0, plane.head<3>().dot(motion));
  const Vector3d direction = motion / length;
  sweep.edges.reserve(1 + body.edges.size());
  sweep.edges.push_back(direction);
  for (const Vector3d& edge : body.edges)
  {
    const Vector3d cross = direction.cross(edge);
    if (cross.norm() < MIN_CROSS_PRODUCT)
      continue;
    sweep.edges.push_back(edge);
    for (const Vector3d& normal : {Vector3d(cross.normalized()), Vector3d(-cross.normalized())})
    {
      const double farthest = reach(body.vertices, normal);
      if (sweepsAFace(body.vertices, normal, farthest, direction) && !isAmong(sweep.planes, normal))
        sweep.planes.emplace_back(normal.x(), normal.y(), normal.z(), -farthest);
    }
  }
  return sweep;
}

double signedDistance(const ConvexBody& body, const Vector3d& p)
{
  double distance = -std::numeric_limits<double>::infinity();
  for (const Vector4d& plane : body.planes)
    distance = std::max(distance, plane.head<3>().dot(p) + plane.w());
  return distance;
}

double clearance(const ConvexBody& a, const ConvexBody& b)
{
  // The faces of the Minkowski difference of two polytopes are spanned by a face of one or by an edge of each, hence
  // the largest separation over these axes is exact wherever a face decides.
  double clearance = -std::numeric_limits<double>::infinity();
  for (const Vector4d& plane : a.planes)
    clearance = std::max(clearance, plane.w() - reach(b.vertices, -plane.head<3>()));
  for (const Vector4d& plane : b.planes)
    clearance = std::max(clearance, plane.w() - reach(a.vertices, -plane.head<3>()));
  for (const Vector3d& edge_a : a.edges)
    for (const Vector3d& edge_b : b.edges)
    {
      const Vector3d cross = edge_a.cross(edge_b);
      const double length = cross.norm();
      if (length < MIN_CROSS_PRODUCT)
        continue;
      const Vector3d axis = cross / length;
      const Extent of_a(a.vertices, axis);
      const Extent of_b(b.vertices, axis);
      clearance = std::max({clearance, of_b.low - of_a.high, of_a.low - of_b.high});
    }
  return clearance;
}

TriangleMesh toMesh(const ConvexBody& body)
{
  TriangleMesh mesh;
  for (const Vector3d& v : body.vertices)
    mesh.vertices.push_back(v.cast<float>());
  for (const Vector4d& plane : body.planes)
  {
    const std::vector<std::uint32_t> corners = cornersOfFace(body, plane);
    for (std::size_t k = 2; k < corners.size(); ++k)
      mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
  }
  return mesh;
}
}  // namespace bin_picking
