// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>

#include <unordered_map>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/mesh.hpp"
#include "part_size.hpp"

namespace bin_picking
{
namespace
{
/// Vertices closer than this share of the bounding box are the same corner, written with another rounding.
constexpr double WELD_SHARE = 1e-6;

void appendMesh(const aiMesh& source, double scale, TriangleMesh& mesh)
{
  const auto offset = static_cast<std::uint32_t>(mesh.vertices.size());
  for (unsigned i = 0; i < source.mNumVertices; ++i)
  {
    const aiVector3D& v = source.mVertices[i];
    mesh.vertices.push_back((Eigen::Vector3d(v.x, v.y, v.z) * scale).cast<float>());
  }
  for (unsigned i = 0; i < source.mNumFaces; ++i)
  {
    const aiFace& face = source.mFaces[i];
    if (face.mNumIndices == 3)
      mesh.triangles.push_back({offset + face.mIndices[0], offset + face.mIndices[1], offset + face.mIndices[2]});
  }
}

TriangleMesh importTriangles(const std::string& path, double scale)
{
  requireReadableFile(path);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate | aiProcess_PreTransformVertices);
  if (!scene)
    throw FileError("cannot read the mesh '" + path + "' (" + importer.GetErrorString() +
                    "); STL, PLY and OBJ files with triangles are supported: export it again in one of these");
  TriangleMesh mesh;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i)
    appendMesh(*scene->mMeshes[i], scale, mesh);
  if (mesh.empty())
    throw FileError("the mesh '" + path + "' has no triangles; export the surface of the part and not its edges");
  return mesh;
}

using Cell = Eigen::Matrix<std::int64_t, 3, 1>;

struct CellHash
{
  std::size_t operator()(const Cell& c) const { return hashBytes(c.data(), 3 * sizeof(std::int64_t)); }
};

/// For each vertex the first vertex of the file within `tolerance` of it.
std::vector<std::uint32_t> firstAtSamePlace(const std::vector<Eigen::Vector3f>& vertices, double tolerance)
{
  std::unordered_map<Cell, std::vector<std::uint32_t>, CellHash> grid;
  const auto cellOf = [tolerance](const Eigen::Vector3d& p) -> Cell {
    return (p / (4 * tolerance)).array().floor().cast<std::int64_t>();
  };
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(tolerance);
  std::vector<std::uint32_t> first(vertices.size());
  for (std::uint32_t i = 0; i < vertices.size(); ++i)
  {
    const Eigen::Vector3d p = vertices[i].cast<double>();
    const Cell low = cellOf(p - reach);
    const Cell high = cellOf(p + reach);
    first[i] = i;
    Cell c;
    for (c.x() = low.x(); c.x() <= high.x(); ++c.x())
      for (c.y() = low.y(); c.y() <= high.y(); ++c.y())
        for (c.z() = low.z(); c.z() <= high.z(); ++c.z())
          if (const auto found = grid.find(c); found != grid.end())
            for (const std::uint32_t other : found->second)
              if (other < first[i] && (vertices[other].cast<double>() - p).norm() <= tolerance)
                first[i] = other;
    if (first[i] == i)
      grid[cellOf(p)].push_back(i);
  }
  return first;
}

/// Joins vertices at the same place and drops those that no triangle uses.
TriangleMesh weld(const TriangleMesh& mesh)
{
  const double tolerance = std::max(WELD_SHARE * boundingBoxDiagonal(mesh.vertices), 1e-12);
  const std::vector<std::uint32_t> first = firstAtSamePlace(mesh.vertices, tolerance);
  constexpr std::uint32_t UNUSED = 0xffffffffu;
  std::vector<std::uint32_t> renumbered(mesh.vertices.size(), UNUSED);
  TriangleMesh welded;
  for (const auto& triangle : mesh.triangles)
  {
    std::array<std::uint32_t, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
    {
      std::uint32_t& index = renumbered[first[triangle[k]]];
      if (index == UNUSED)
      {
        index = static_cast<std::uint32_t>(welded.vertices.size());
        welded.vertices.push_back(mesh.vertices[first[triangle[k]]]);
      }
      corners[k] = index;
    }
    welded.triangles.push_back(corners);
  }
  return welded;
}

bool isDegenerate(const std::array<std::uint32_t, 3>& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

void dropDegenerateTriangles(TriangleMesh& mesh)
{
  const auto end = std::remove_if(mesh.triangles.begin(), mesh.triangles.end(), isDegenerate);
  const auto dropped = mesh.triangles.end() - end;
  mesh.triangles.erase(end, mesh.triangles.end());
  if (dropped > 0)
    mesh.repairs.push_back(std::to_string(dropped) + " degenerate triangles (two corners at one place) were dropped.");
}

void turnOutside(TriangleMesh& mesh)
{
  const MeshReport report = inspectMesh(mesh);
  if (report.open_edges > 0 || report.volume >= 0)
    return;
  for (auto& triangle : mesh.triangles)
    std::swap(triangle[1], triangle[2]);
  mesh.repairs.push_back("The mesh was inside out (its triangles ran clockwise seen from outside) and was turned.");
}
}  // namespace

TriangleMesh loadMesh(const std::string& path, LengthUnit unit)
{
  const TriangleMesh raw = importTriangles(path, metresPer(unit));
  checkPartShape(raw.vertices, path, unit);
  TriangleMesh mesh = weld(raw);
  dropDegenerateTriangles(mesh);
  if (mesh.empty())
    throw FileError("all triangles of the mesh '" + path + "' are degenerate (without area); export it again");
  turnOutside(mesh);
  return mesh;
}
}  // namespace bin_picking
