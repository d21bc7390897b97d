// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking
{
/// A convex polytope: the hull of its corners, metres. Made by the functions below, which keep the three lists in step.
struct ConvexBody
{
  std::vector<Eigen::Vector3d> vertices;  ///< the corners
  std::vector<Eigen::Vector4d> planes;    ///< of the faces: (outward unit normal n, d), inside where n.p + d <= 0
  std::vector<Eigen::Vector3d> edges;     ///< unit directions of the edges, no two parallel
};

/// A box along the axes. \throws ParameterError a size that is not positive
ConvexBody makeBox(const Eigen::Vector3d& center, const Eigen::Vector3d& size);

/// The smallest convex body round the points. Triangles that lie in one plane (to 1e-7 of the extent) are one face. No
/// point sticks out of the planes.
/// \throws ParameterError fewer than four points, points that are not finite, or points in one plane
ConvexBody makeHull(const std::vector<Eigen::Vector3d>& points);

/// The body moved by T.
ConvexBody transformed(const ConvexBody& body, const Pose& T);

/// The hull of the body at the start and at the end of a straight motion (metres): exactly what it covers on the way,
/// nothing thin is jumped over. Its faces are those of the body and those that its outline's edges sweep.
ConvexBody swept(const ConvexBody& body, const Eigen::Vector3d& motion);

/// Signed distance of a point from the surface, metres: exact inside (< 0) and where a face is nearest, else a lower
/// bound.
double signedDistance(const ConvexBody& body, const Eigen::Vector3d& p);

/// Signed clearance of two bodies in one frame by separating axes, metres.
/// Overlapping: minus the exact penetration depth (the shortest motion that would part them).
/// Apart: a lower bound of the distance, exact where a face or two crossing edges are nearest. For two boxes the true
/// distance is at most sqrt(3) times larger.
double clearance(const ConvexBody& a, const ConvexBody& b);

/// The surface as triangles, counter-clockwise seen from outside: for drawing and for exact tests.
TriangleMesh toMesh(const ConvexBody& body);
}  // namespace bin_picking
