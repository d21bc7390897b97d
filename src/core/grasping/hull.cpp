// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/grasping/convex_body.hpp"

namespace bin_picking
{
namespace
{
using Eigen::Vector3d;
using Eigen::Vector4d;

// Of the extent: points this close to a plane lie on it. Well above the rounding of single precision files.
constexpr double COPLANAR = 1e-7;
// Of the extent: a body that is nowhere thicker is flat.
constexpr double MIN_THICKNESS = 1e-5;
// Sine of the angle between normals of one face, or directions of one edge: slivers carry no better ones.
constexpr double PARALLEL = 1e-5;

struct Triangle
{
  std::array<std::size_t, 3> corners;
  Vector4d plane;
};

/// The hull as triangles, grown point by point: what a new point sees of it gives way to a fan from its horizon.
class GrowingHull
{
public:
  explicit GrowingHull(const std::vector<Vector3d>& points) : points_(points)
  {
    Vector3d low = points[0];
    Vector3d high = points[0];
    for (const Vector3d& p : points)
    {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    extent_ = (high - low).norm();
    begin();
    for (std::size_t i = 0; i < points_.size(); ++i)
      add(i);
  }

  const std::vector<Triangle>& triangles() const { return triangles_; }
  double extent() const { return extent_; }

private:
  double height(const Triangle& triangle, std::size_t point) const
  {
    return triangle.plane.head<3>().dot(points_[point]) + triangle.plane.w();
  }

  template <typename Measure>
  std::size_t farthest(const Measure& measure, double least) const
  {
    std::size_t best = 0;
    double value = -1;
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (measure(points_[i]) > value)
      {
        value = measure(points_[i]);
        best = i;
      }
    if (!(value > least))
      throw ParameterError("The " + std::to_string(points_.size()) +
                           " points lie in one plane, on one line or in one place: they span no convex body; give at "
                           "least four that do.");
    return best;
  }

  void begin()
  {
    const double least = MIN_THICKNESS * extent_;
    const Vector3d a = points_[0];
    const std::size_t second = farthest([&](const Vector3d& p) { return (p - a).norm(); }, least);
    const Vector3d along = (points_[second] - a).normalized();
    const std::size_t third = farthest([&](const Vector3d& p) { return (p - a).cross(along).norm(); }, least);
    const Vector3d normal = along.cross(points_[third] - a).normalized();
    const std::size_t fourth = farthest([&](const Vector3d& p) { return std::abs(normal.dot(p - a)); }, least);
    middle_ = (a + points_[second] + points_[third] + points_[fourth]) / 4;
    for (const auto& corners : {std::array<std::size_t, 3>{0, second, third},
                                {0, second, fourth},
                                {0, third, fourth},
                                {second, third, fourth}})
      addTriangle(corners);
  }

  void addTriangle(std::array<std::size_t, 3> corners)
  {
    const Vector3d& a = points_[corners[0]];
    Vector3d normal = (points_[corners[1]] - a).cross(points_[corners[2]] - a).normalized();
    if (normal.dot(a - middle_) < 0)
    {
      normal = -normal;
      std::swap(corners[1], corners[2]);
    }
    triangles_.push_back({corners, Vector4d(normal.x(), normal.y(), normal.z(), -normal.dot(a))});
  }

  void add(std::size_t point)
  {
    const double tolerance = COPLANAR * extent_;
    const bool outside = std::any_of(triangles_.begin(), triangles_.end(),
                                     [&](const Triangle& t) { return height(t, point) > tolerance; });
    if (!outside)
      return;
    // What lies in one plane with the point goes as well: a fan onto its edge could have triangles without area.
    std::vector<Triangle> kept;
    std::set<std::pair<std::size_t, std::size_t>> edges;
    for (const Triangle& t : triangles_)
      if (height(t, point) > -tolerance)
        for (std::size_t k = 0; k < 3; ++k)
          edges.emplace(t.corners[k], t.corners[(k + 1) % 3]);
      else
        kept.push_back(t);
    triangles_ = std::move(kept);
    for (const auto& [from, to] : edges)
      if (edges.count({to, from}) == 0)
        addTriangle({from, to, point});
  }

  const std::vector<Vector3d>& points_;
  double extent_ = 0;
  Vector3d middle_;
  std::vector<Triangle> triangles_;
};

/// Gathers triangles of one plane. \return the face of each triangle
std::vector<std::size_t> mergeFaces(const std::vector<Vector3d>& points, const GrowingHull& hull,
                                    std::vector<Vector4d>& planes)
{
  const auto area = [&](const Triangle& t) {
    return (points[t.corners[1]] - points[t.corners[0]]).cross(points[t.corners[2]] - points[t.corners[0]]).norm();
  };
  // Largest first: the slivers join a face whose normal is exact.
  std::vector<std::size_t> order(hull.triangles().size());
  for (std::size_t i = 0; i < order.size(); ++i)
    order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return area(hull.triangles()[a]) > area(hull.triangles()[b]); });
  std::vector<std::size_t> face_of(order.size());
  for (const std::size_t i : order)
  {
    const Triangle& t = hull.triangles()[i];
    const auto same = std::find_if(planes.begin(), planes.end(), [&](const Vector4d& plane) {
      if (plane.head<3>().dot(t.plane.head<3>()) <= 0)
        return false;
      const bool on_plane = std::all_of(t.corners.begin(), t.corners.end(), [&](std::size_t c) {
        return std::abs(plane.head<3>().dot(points[c]) + plane.w()) < 10 * COPLANAR * hull.extent();
      });
      return on_plane || plane.head<3>().cross(t.plane.head<3>()).norm() < PARALLEL;
    });
    face_of[i] = static_cast<std::size_t>(same - planes.begin());
    if (same == planes.end())
      planes.push_back(t.plane);
  }
  return face_of;
}

void addEdge(std::vector<Vector3d>& edges, const Vector3d& direction)
{
  if (std::none_of(edges.begin(), edges.end(),
                   [&](const Vector3d& edge) { return edge.cross(direction).norm() < PARALLEL; }))
    edges.push_back(direction);
}

/// Directions of the edges between different faces.
std::vector<Vector3d> edgesOf(const std::vector<Vector3d>& points, const GrowingHull& hull,
                              const std::vector<std::size_t>& face_of)
{
  std::vector<std::array<std::size_t, 3>> sides;  // lower corner, higher corner, face
  for (std::size_t i = 0; i < hull.triangles().size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
    {
      const auto [low, high] = std::minmax(hull.triangles()[i].corners[k], hull.triangles()[i].corners[(k + 1) % 3]);
      sides.push_back({low, high, face_of[i]});
    }
  std::sort(sides.begin(), sides.end());
  std::vector<Vector3d> edges;
  for (std::size_t i = 1; i < sides.size(); ++i)
    if (sides[i][0] == sides[i - 1][0] && sides[i][1] == sides[i - 1][1] && sides[i][2] != sides[i - 1][2])
      addEdge(edges, (points[sides[i][1]] - points[sides[i][0]]).normalized());
  return edges;
}

/// The corners of the triangles where at least three faces meet.
std::vector<Vector3d> cornersOf(const std::vector<Vector3d>& points, const GrowingHull& hull,
                                const std::vector<std::size_t>& face_of)
{
  std::set<std::pair<std::size_t, std::size_t>> faces_at;
  for (std::size_t i = 0; i < hull.triangles().size(); ++i)
    for (const std::size_t corner : hull.triangles()[i].corners)
      faces_at.emplace(corner, face_of[i]);
  std::vector<Vector3d> corners;
  for (auto it = faces_at.begin(); it != faces_at.end();)
  {
    const auto end = faces_at.upper_bound({it->first, std::numeric_limits<std::size_t>::max()});
    if (std::distance(it, end) >= 3)
      corners.push_back(points[it->first]);
    it = end;
  }
  return corners;
}
}  // namespace

ConvexBody makeHull(const std::vector<Vector3d>& points)
{
  if (points.size() < 4)
    throw ParameterError("A convex body needs at least 4 points that are not in one plane, but there are " +
                         std::to_string(points.size()) + ".");
  if (std::any_of(points.begin(), points.end(), [](const Vector3d& p) { return !p.allFinite(); }))
    throw ParameterError("A point of a convex body is not finite; remove it.");
  const GrowingHull hull(points);
  ConvexBody body;
  const std::vector<std::size_t> face_of = mergeFaces(points, hull, body.planes);
  body.edges = edgesOf(points, hull, face_of);
  body.vertices = cornersOf(points, hull, face_of);
  // What was taken as lying in a plane may stick out of it by the tolerance: nothing shall.
  for (Vector4d& plane : body.planes)
    for (const Vector3d& p : points)
      plane.w() = std::min(plane.w(), -plane.head<3>().dot(p));
  return body;
}
}  // namespace bin_picking
