// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"

namespace bin_picking
{
/// Triangles in metres; vertices counter-clockwise seen from outside.
struct TriangleMesh
{
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::string> repairs = {};  ///< what loadMesh changed, in sentences; inspectMesh repeats them

  bool empty() const { return triangles.empty(); }
};

/// The unit in which a CAD file was drawn. Files do not say; the user must.
enum class LengthUnit
{
  Metre,
  Centimetre,
  Millimetre,
  Inch
};

/// "m", "cm", "mm" or "inch". \throws ParameterError otherwise, listing them
LengthUnit parseLengthUnit(const std::string& text);
std::string toString(LengthUnit unit);
double metresPer(LengthUnit unit);

/// What a look at a mesh tells: for the summary of `train`, and for warnings.
struct MeshReport
{
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< edges of the bounding box, metres
  double diameter = 0;                             ///< largest distance between two vertices, metres
  double area = 0;                                 ///< square metres
  double volume = 0;                               ///< signed, cubic metres; < 0: turned inside out
  int open_edges = 0;                              ///< edges that do not have exactly two triangles
  int degenerate_triangles = 0;
  std::vector<std::string> warnings;  ///< sentences: holes, inside-out, odd size, ...
};

/// Reads STL, PLY or OBJ. Vertices are welded, degenerate triangles dropped, an inside-out closed mesh turned (and both
/// reported by inspectMesh's warnings when asked on the result of loadMesh).
/// \throws FileError missing, unreadable, empty, flat (no volume of the bounding box in some direction), not finite, or
/// of a
///   size that no part in a bin has (diameter outside 2 mm ... 2 m: the message names the unit that would fit)
TriangleMesh loadMesh(const std::string& path, LengthUnit unit);

/// Size, area, volume and flaws. Holes and the like are warnings: such a mesh can still be trained.
MeshReport inspectMesh(const TriangleMesh& mesh);

/// Largest distance of two points, metres: exact for most shapes, never more and at most 0.4 % less than the true one.
/// 0 for fewer than two points.
double largestDistance(const std::vector<Eigen::Vector3f>& points);

/// Points drawn evenly from the surface with the normals of their triangles.
/// \param spacing mean distance of neighbouring points, metres (the number of points is area / spacing^2)
/// \param seed the same seed gives the same points
/// \throws ParameterError spacing not positive, or so fine that more than 20 million points would be drawn
OrientedPoints sampleSurface(const TriangleMesh& mesh, double spacing, std::uint32_t seed);

/// Reads a PLY of points with normals (x y z nx ny nz; faces, if any, are not used). Normals are normalised; points
/// with non-finite coordinates or a zero normal are dropped.
/// \throws FileError missing, unreadable, truncated, no normals, no points left, or of a size that no part has (see
/// loadMesh)
OrientedPoints loadOrientedPoints(const std::string& path, LengthUnit unit);

/// Whether a file is a PLY with points and normals but no faces (a point model and not a mesh).
/// \throws FileError a PLY that is missing or whose header cannot be read
bool isPointModel(const std::string& path);

/// Content hash of a file's bytes (FNV-1a, 64 bit). \throws FileError if it cannot be read
std::uint64_t hashFile(const std::string& path);

/// Hash of arbitrary bytes, chainable through `seed`.
std::uint64_t hashBytes(const void* data, std::size_t size, std::uint64_t seed = 14695981039346656037ull);
}  // namespace bin_picking
