// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "collision_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "triangle_distance.hpp"

namespace bin_picking::simulation
{
namespace
{
constexpr double SPACING = 0.0015;  // metres between points of the surface
constexpr double SEARCH_START = 0.001;

std::vector<Triangle> trianglesOf(const TriangleMesh& mesh)
{
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    triangles.push_back(
        {mesh.vertices[t[0]].cast<double>(), mesh.vertices[t[1]].cast<double>(), mesh.vertices[t[2]].cast<double>()});
  return triangles;
}

std::vector<Eigen::AlignedBox3d> boxesOf(const std::vector<Triangle>& triangles)
{
  std::vector<Eigen::AlignedBox3d> boxes;
  boxes.reserve(triangles.size());
  for (const Triangle& t : triangles)
    boxes.push_back(Eigen::AlignedBox3d(t[0]).extend(t[1]).extend(t[2]));
  return boxes;
}

std::vector<Eigen::AlignedBox3d> boxesOf(const std::vector<Eigen::Vector3d>& points)
{
  std::vector<Eigen::AlignedBox3d> boxes;
  boxes.reserve(points.size());
  for (const Eigen::Vector3d& p : points)
    boxes.emplace_back(p);
  return boxes;
}

std::vector<Eigen::Vector3d> pointsOf(const TriangleMesh& mesh, const std::vector<Triangle>& triangles)
{
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3f& p : mesh.vertices)
    points.push_back(p.cast<double>());
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k)
    {
      const Eigen::Vector3d side = t[(k + 1) % 3] - t[k];
      const int pieces = static_cast<int>(std::ceil(side.norm() / SPACING));
      for (int i = 1; i < pieces; ++i)
        points.emplace_back(t[k] + side * i / pieces);
    }
  for (const Eigen::Vector3f& p : sampleSurface(mesh, SPACING, 1).points)
    points.push_back(p.cast<double>());
  return points;
}
}  // namespace

CollisionMesh::CollisionMesh(std::shared_ptr<const TriangleMesh> mesh)
    : mesh_(std::move(mesh)),
      solid_(*mesh_),
      triangles_(trianglesOf(*mesh_)),
      tree_(boxesOf(triangles_)),
      surface_(pointsOf(*mesh_, triangles_)),
      surface_tree_(boxesOf(surface_))
{}

bool CollisionMesh::contains(const Eigen::Vector3d& point) const { return bounds().contains(point) && solid_(point); }

double CollisionMesh::depth(const Eigen::Vector3d& point) const
{
  if (!contains(point))
    return 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (double reach = SEARCH_START; !(nearest <= reach * reach); reach *= 2)
  {
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(reach);
    tree_.visit({point - margin, point + margin}, [&](std::size_t k) {
      const Triangle& t = triangles_[k];
      nearest = std::min(nearest, squaredDistanceToTriangle(point, t[0], t[1], t[2]));
    });
  }
  return std::sqrt(nearest);
}

std::optional<double> firstOverlap(const CollisionMesh& mesh, const ConvexBody& body, const Eigen::Vector3d& motion,
                                   double end, double depth)
{
  std::optional<double> first;
  mesh.tree().visit(boundsOf(body, motion * end), [&](std::size_t k) {
    const TimeSpan span = overlapTimes(body, motion, mesh.triangles()[k], {0, first ? *first : end}, depth);
    if (!span.empty())
      first = span.begin;
  });
  return first;
}

Eigen::AlignedBox3d boundsOf(const ConvexBody& body)
{
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : body.vertices)
    box.extend(p);
  return box;
}

Eigen::AlignedBox3d boundsOf(const ConvexBody& body, const Eigen::Vector3d& motion)
{
  Eigen::AlignedBox3d box = boundsOf(body);
  box.extend(Eigen::AlignedBox3d(box).translate(motion));
  return box;
}

Eigen::AlignedBox3d boundsOf(const Eigen::AlignedBox3d& box, const Pose& T_target_box)
{
  const Eigen::Vector3d half = T_target_box.linear().cwiseAbs() * (0.5 * box.sizes());
  const Eigen::Vector3d center = T_target_box * box.center();
  return {center - half, center + half};
}
}  // namespace bin_picking::simulation
