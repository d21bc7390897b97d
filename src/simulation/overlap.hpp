// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <memory>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/mesh.hpp"
#include "mesh_solid.hpp"

namespace bin_picking::simulation
{
/// A closed mesh, made ready to be held against others: the true surface, whatever simpler bodies the physics uses.
class OverlapShape
{
public:
  explicit OverlapShape(std::shared_ptr<const TriangleMesh> mesh);

  const std::vector<Eigen::Vector3d>& surface() const { return surface_; }
  const Eigen::Vector3d& center() const { return center_; }
  double radius() const { return radius_; }

  /// How deep a point lies inside, metres; 0 outside.
  double depth(const Eigen::Vector3d& point) const;

private:
  std::shared_ptr<const TriangleMesh> mesh_;
  SolidTest solid_;
  Eigen::AlignedBox3d box_;
  std::vector<Eigen::Vector3d> surface_;  ///< its vertices, and points about a millimetre apart
  Eigen::Vector3d center_;
  double radius_ = 0;
};

struct PlacedShape
{
  const OverlapShape* shape = nullptr;
  Pose T_bin_object = Pose::Identity();
};

/// The two bodies that reach deepest into each other.
struct Overlap
{
  double depth = 0;  ///< of a point of one below the surface of the other, metres
  std::size_t first = 0;
  std::size_t second = 0;
};

Overlap deepestOverlap(const std::vector<PlacedShape>& bodies, const Executor& executor);
}  // namespace bin_picking::simulation
