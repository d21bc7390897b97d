// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "bin_picking_perception/model/mesh.hpp"
#include "box_tree.hpp"
#include "mesh_solid.hpp"
#include "triangle_polytope.hpp"

namespace bin_picking::simulation
{
/// A closed mesh, made ready to be held against convex bodies, points and other meshes. All in the frame of the mesh,
/// metres.
class CollisionMesh
{
public:
  explicit CollisionMesh(std::shared_ptr<const TriangleMesh> mesh);

  const std::vector<Triangle>& triangles() const { return triangles_; }
  const BoxTree& tree() const { return tree_; }  ///< of the triangles
  const Eigen::AlignedBox3d& bounds() const { return tree_.bounds(); }

  bool contains(const Eigen::Vector3d& point) const;
  /// How deep a point lies inside, by the true surface; 0 outside.
  double depth(const Eigen::Vector3d& point) const;

  /// Vertices, and points along the edges and on the faces about 1.5 mm apart.
  const std::vector<Eigen::Vector3d>& surface() const { return surface_; }
  const BoxTree& surfaceTree() const { return surface_tree_; }

private:
  std::shared_ptr<const TriangleMesh> mesh_;
  SolidTest solid_;
  std::vector<Triangle> triangles_;
  BoxTree tree_;
  std::vector<Eigen::Vector3d> surface_;
  BoxTree surface_tree_;
};

/// The first moment of a straight motion at which a body and the surface reach into each other, [0, 1].
/// \param body and motion in the frame of the mesh \param end later moments do not matter
/// \param depth see overlapTimes
std::optional<double> firstOverlap(const CollisionMesh& mesh, const ConvexBody& body, const Eigen::Vector3d& motion,
                                   double end = 1, double depth = TOUCH);

Eigen::AlignedBox3d boundsOf(const ConvexBody& body);
/// Bounds of all that the body covers on a straight way.
Eigen::AlignedBox3d boundsOf(const ConvexBody& body, const Eigen::Vector3d& motion);
/// Bounds of a box that was turned and moved.
Eigen::AlignedBox3d boundsOf(const Eigen::AlignedBox3d& box, const Pose& T_target_box);
}  // namespace bin_picking::simulation
