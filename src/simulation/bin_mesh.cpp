// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_mesh.hpp"

namespace bin_picking::simulation
{
namespace
{
constexpr double TABLE_THICKNESS = 0.01;  // metres

void appendBox(TriangleMesh& mesh, const Eigen::Vector3d& low, const Eigen::Vector3d& high)
{
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.emplace_back(Eigen::Vector3d(corner & 1 ? high.x() : low.x(), corner & 2 ? high.y() : low.y(),
                                               corner & 4 ? high.z() : low.z())
                                   .cast<float>());
  constexpr std::uint32_t FACES[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  for (const auto& face : FACES)
    mesh.triangles.push_back({first + face[0], first + face[1], first + face[2]});
}
}  // namespace

TriangleMesh meshOf(const Bin& bin, double table_size)
{
  const Eigen::Vector3d half(bin.inner_size.x() / 2, bin.inner_size.y() / 2, 0);
  const double wall = bin.wall_thickness;
  const double top = bin.inner_size.z();
  const Eigen::Vector3d outer = half + Eigen::Vector3d(wall, wall, 0);
  TriangleMesh mesh;
  appendBox(mesh, {-outer.x(), -outer.y(), -wall}, {outer.x(), outer.y(), 0});
  appendBox(mesh, {-outer.x(), -outer.y(), 0}, {-half.x(), outer.y(), top});
  appendBox(mesh, {half.x(), -outer.y(), 0}, {outer.x(), outer.y(), top});
  appendBox(mesh, {-half.x(), -outer.y(), 0}, {half.x(), -half.y(), top});
  appendBox(mesh, {-half.x(), half.y(), 0}, {half.x(), outer.y(), top});
  if (table_size > 0)
  {
    const double edge = table_size / 2;
    appendBox(mesh, {-edge, -edge, -wall - TABLE_THICKNESS}, {edge, edge, -wall});
  }
  return mesh;
}
}  // namespace bin_picking::simulation
