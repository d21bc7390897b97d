// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "convex_pieces.hpp"

#include <queue>
#include <tuple>
#include <utility>

#include "convex_hull.hpp"
#include "mesh_cutting.hpp"
#include "voxel_solid.hpp"

namespace bin_picking::simulation
{
namespace
{
constexpr int RESOLUTION = 64;  // cubes along the longest edge with which filling is measured

struct Piece
{
  Eigen::AlignedBox3d box;  ///< of the blocks that it is made of
  ConvexHull hull;
  bool alive = true;
};

/// Two neighbouring pieces that may become one.
struct Union
{
  double added = 0;  ///< volume that the joint hull holds beyond the two
  std::size_t a = 0;
  std::size_t b = 0;

  bool operator<(const Union& other) const  // the one to do first is the greatest
  {
    return std::tie(added, a, b) > std::tie(other.added, other.a, other.b);
  }
};

class Joiner
{
public:
  Joiner(const TriangleMesh& mesh, double max_filling) : solid_(mesh, RESOLUTION), max_filling_(max_filling) {}

  void add(const Block& block)
  {
    Piece piece{block.box, convexHull(block.corners), true};
    if (piece.hull.vertices.empty())
      return;  // the solid only touches the box
    pieces_.push_back(std::move(piece));
    for (std::size_t other = 0; other + 1 < pieces_.size(); ++other)
      propose(other, pieces_.size() - 1);
  }

  /// Joins what may be joined, whatever adds least first.
  void run()
  {
    while (!unions_.empty())
    {
      const Union next = unions_.top();
      unions_.pop();
      if (!pieces_[next.a].alive || !pieces_[next.b].alive)
        continue;
      Piece joint = join(pieces_[next.a], pieces_[next.b]);
      if (fillsTooMuch(joint))
        continue;
      pieces_[next.a].alive = pieces_[next.b].alive = false;
      pieces_.push_back(std::move(joint));
      for (std::size_t other = 0; other + 1 < pieces_.size(); ++other)
        propose(other, pieces_.size() - 1);
    }
  }

  std::vector<ConvexPiece> pieces() const
  {
    std::vector<ConvexPiece> result;
    for (const Piece& piece : pieces_)
      if (piece.alive)
      {
        ConvexPiece corners;
        for (const Eigen::Vector3d& vertex : piece.hull.vertices)
          corners.push_back(vertex.cast<float>());
        result.push_back(std::move(corners));
      }
    return result;
  }

private:
  static Piece join(const Piece& a, const Piece& b)
  {
    std::vector<Eigen::Vector3d> corners = a.hull.vertices;
    corners.insert(corners.end(), b.hull.vertices.begin(), b.hull.vertices.end());
    return {a.box.merged(b.box), convexHull(corners), true};
  }

  void propose(std::size_t a, std::size_t b)
  {
    constexpr double TOUCHING = 1e-6;  // metres
    if (!pieces_[a].alive || !pieces_[b].alive)
      return;
    if (pieces_[a].box.squaredExteriorDistance(pieces_[b].box) > TOUCHING * TOUCHING)
      return;
    const double volume = join(pieces_[a], pieces_[b]).hull.volume;
    unions_.push({volume - pieces_[a].hull.volume - pieces_[b].hull.volume, a, b});
  }

  bool fillsTooMuch(const Piece& piece) const
  {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& vertex : piece.hull.vertices)
      box.extend(vertex);
    const auto cubes = [&](const Eigen::Vector3d& p) -> Eigen::Array3d {
      return (p - solid_.origin()).array() / solid_.edge() - 0.5;
    };
    const Eigen::Array3i first = cubes(box.min()).ceil().cast<int>().max(0);
    const Eigen::Array3i last = cubes(box.max()).floor().cast<int>().min(solid_.size().array() - 1);
    Eigen::Vector3i cube;
    for (cube.z() = first.z(); cube.z() <= last.z(); ++cube.z())
      for (cube.y() = first.y(); cube.y() <= last.y(); ++cube.y())
        for (cube.x() = first.x(); cube.x() <= last.x(); ++cube.x())
          if (solid_.distance(cube) > max_filling_ && piece.hull.contains(solid_.center(cube)))
            return true;
    return false;
  }

  VoxelSolid solid_;
  double max_filling_;
  std::vector<Piece> pieces_;
  std::priority_queue<Union> unions_;
};
}  // namespace

std::vector<ConvexPiece> convexPieces(const TriangleMesh& mesh, const ConvexPiecesParameters& parameters)
{
  const double diameter = largestDistance(mesh.vertices);
  Joiner joiner(mesh, parameters.max_filling * diameter);
  for (const Block& block : cutIntoBlocks(mesh, parameters.block_size * diameter))
    joiner.add(block);
  joiner.run();
  return joiner.pieces();
}
}  // namespace bin_picking::simulation
