// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <vector>

#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking::simulation
{
/// Corners of a convex body, metres, part frame.
using ConvexPiece = std::vector<Eigen::Vector3f>;

struct ConvexPiecesParameters
{
  /// Depth to which joining may fill hollows of the part, share of its diameter; measured to 1/64 of the part's longest
  /// edge. Hollows within one block are filled.
  double max_filling = 0.02;
  double block_size = 0.1;  ///< of the blocks from which pieces are put together, share of the diameter
};

/// Cuts a part into small blocks and joins neighbours to convex pieces as long as their hull fills little that is not
/// the part. The hulls are those of exact pieces of the mesh: together they cover it, but for the rounding of
/// convexHull(), so bodies whose pieces do not overlap do not overlap either.
/// \param mesh closed
std::vector<ConvexPiece> convexPieces(const TriangleMesh& mesh, const ConvexPiecesParameters& parameters = {});
}  // namespace bin_picking::simulation
