// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking
{
namespace
{
/// A triangle this much flatter than long is a line, up to the rounding of its corners.
constexpr double DEGENERATE_SHARE = 1e-6;

/// An edge of a triangle, with its direction of travel.
struct Edge
{
  std::uint32_t low;
  std::uint32_t high;
  bool forward;  ///< from low to high

  bool sameAs(const Edge& other) const { return low == other.low && high == other.high; }
};

std::vector<Edge> sortedEdges(const TriangleMesh& mesh)
{
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
    {
      const std::uint32_t from = t[k];
      const std::uint32_t to = t[(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), from < to});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.forward < b.forward;
  });
  return edges;
}

struct EdgeCounts
{
  int open = 0;          ///< without exactly two triangles
  int inconsistent = 0;  ///< two triangles that run along it in the same direction
};

EdgeCounts countEdges(const TriangleMesh& mesh)
{
  const std::vector<Edge> edges = sortedEdges(mesh);
  EdgeCounts counts;
  std::size_t end = 0;
  for (std::size_t begin = 0; begin < edges.size(); begin = end)
  {
    for (end = begin + 1; end < edges.size() && edges[end].sameAs(edges[begin]);)
      ++end;
    if (end - begin != 2)
      ++counts.open;
    else if (edges[begin].forward == edges[begin + 1].forward)
      ++counts.inconsistent;
  }
  return counts;
}

void measure(const TriangleMesh& mesh, MeshReport& report)
{
  Eigen::Vector3d low = mesh.vertices.front().cast<double>();
  Eigen::Vector3d high = low;
  for (const auto& v : mesh.vertices)
  {
    low = low.cwiseMin(v.cast<double>());
    high = high.cwiseMax(v.cast<double>());
  }
  report.size = high - low;
  // About the middle, so that holes and rounding matter least.
  const Eigen::Vector3d center = (low + high) / 2;
  for (const auto& t : mesh.triangles)
  {
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>() - center;
    const Eigen::Vector3d b = mesh.vertices[t[1]].cast<double>() - center;
    const Eigen::Vector3d c = mesh.vertices[t[2]].cast<double>() - center;
    const double twice_area = (b - a).cross(c - a).norm();
    report.area += twice_area / 2;
    report.volume += a.dot(b.cross(c)) / 6;
    const double longest_squared = std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()});
    if (twice_area <= DEGENERATE_SHARE * longest_squared)
      ++report.degenerate_triangles;
  }
}

void warn(const EdgeCounts& edges, MeshReport& report)
{
  if (edges.open > 0)
    report.warnings.push_back("The mesh has holes or inner walls: " + std::to_string(edges.open) +
                              " edges do not have exactly two triangles; views through a hole see the inside.");
  if (edges.inconsistent > 0)
    report.warnings.push_back("Neighbouring triangles disagree about the outside at " +
                              std::to_string(edges.inconsistent) +
                              " edges; surfaces with normals pointing inwards are not learned: unify the normals.");
  if (report.volume < 0)
    report.warnings.push_back("The mesh is probably inside out (its volume is negative); turn its normals outwards.");
  if (report.degenerate_triangles > 0)
    report.warnings.push_back(std::to_string(report.degenerate_triangles) + " triangles have no area.");
}
}  // namespace

MeshReport inspectMesh(const TriangleMesh& mesh)
{
  MeshReport report;
  report.warnings = mesh.repairs;
  if (mesh.empty())
  {
    report.warnings.push_back("The mesh has no triangles.");
    return report;
  }
  measure(mesh, report);
  report.diameter = largestDistance(mesh.vertices);
  const EdgeCounts edges = countEdges(mesh);
  report.open_edges = edges.open;
  warn(edges, report);
  return report;
}
}  // namespace bin_picking
