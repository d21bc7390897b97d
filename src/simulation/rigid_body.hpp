// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "bin_picking_perception/model/mesh.hpp"
#include "convex_pieces.hpp"

namespace bin_picking::simulation
{
/// What the physics needs of a part.
struct RigidBodyShape
{
  std::string name = "part";                                 ///< for messages
  std::vector<ConvexPiece> pieces;                           ///< together they cover the part; see convexPieces()
  double volume = 0;                                         ///< cubic metres
  Eigen::Vector3d center_of_mass = Eigen::Vector3d::Zero();  ///< of the solid at even density, part frame
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();         ///< about the centre of mass, per unit of density
  double radius = 0;                                         ///< farthest vertex from the centre of mass
};

/// \throws ParameterError the mesh is not closed, so that it has no inside
RigidBodyShape makeRigidBodyShape(const TriangleMesh& mesh);
}  // namespace bin_picking::simulation
