// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "overlap.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "triangle_distance.hpp"

namespace bin_picking::simulation
{
namespace
{
constexpr double SPACING = 0.001;  // metres between points of the surface

/// How deep the surface of one reaches into the other.
double reach(const PlacedShape& one, const PlacedShape& other)
{
  const Pose T_other_one = other.T_bin_object.inverse() * one.T_bin_object;
  double deepest = 0;
  for (const Eigen::Vector3d& p : one.shape->surface())
    deepest = std::max(deepest, other.shape->depth(T_other_one * p));
  return deepest;
}
}  // namespace

OverlapShape::OverlapShape(std::shared_ptr<const TriangleMesh> mesh) : mesh_(std::move(mesh)), solid_(*mesh_)
{
  for (const Eigen::Vector3f& p : mesh_->vertices)
  {
    surface_.push_back(p.cast<double>());
    box_.extend(surface_.back());
  }
  for (const Eigen::Vector3f& p : sampleSurface(*mesh_, SPACING, 1).points)
    surface_.push_back(p.cast<double>());
  center_ = box_.center();
  radius_ = 0.5 * box_.diagonal().norm();
}

double OverlapShape::depth(const Eigen::Vector3d& point) const
{
  if (!box_.contains(point) || !solid_(point))
    return 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& t : mesh_->triangles)
    nearest =
        std::min(nearest, squaredDistanceToTriangle(point, mesh_->vertices[t[0]].cast<double>(),
                                          mesh_->vertices[t[1]].cast<double>(), mesh_->vertices[t[2]].cast<double>()));
  return std::sqrt(nearest);
}

Overlap deepestOverlap(const std::vector<PlacedShape>& bodies, const Executor& executor)
{
  std::vector<Overlap> pairs;
  for (std::size_t a = 0; a < bodies.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
    {
      const double distance =
          (bodies[a].T_bin_object * bodies[a].shape->center() - bodies[b].T_bin_object * bodies[b].shape->center())
              .norm();
      if (distance < bodies[a].shape->radius() + bodies[b].shape->radius())
        pairs.push_back({0, a, b});
    }
  executor.forEach(pairs.size(), [&](std::size_t k) {
    const PlacedShape& a = bodies[pairs[k].first];
    const PlacedShape& b = bodies[pairs[k].second];
    pairs[k].depth = std::max(reach(a, b), reach(b, a));
  });
  const auto deepest = std::max_element(pairs.begin(), pairs.end(),
                                        [](const Overlap& a, const Overlap& b) { return a.depth < b.depth; });
  return deepest == pairs.end() ? Overlap{} : *deepest;
}
}  // namespace bin_picking::simulation
