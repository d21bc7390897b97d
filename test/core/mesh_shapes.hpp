// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cmath>
#include <cstring>
#include <map>
#include <sstream>
#include <string>
#include <utility>

#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking
{
namespace test
{
/// A box about the origin, two triangles per face, outward.
inline TriangleMesh box(float x, float y, float z)
{
  TriangleMesh mesh;
  for (const float k : {-0.5f, 0.5f})
    for (const float j : {-0.5f, 0.5f})
      for (const float i : {-0.5f, 0.5f})
        mesh.vertices.emplace_back(i * x, j * y, k * z);
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// A sphere about the origin: an octahedron whose triangles are split in four `levels` times.
inline TriangleMesh sphereMesh(float radius, int levels)
{
  TriangleMesh mesh;
  mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level)
  {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto inserted = middles.emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
      if (inserted.second)
        mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
      return inserted.first->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& t : mesh.triangles)
    {
      const std::uint32_t a = middle(t[0], t[1]);
      const std::uint32_t b = middle(t[1], t[2]);
      const std::uint32_t c = middle(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}});
    }
    mesh.triangles = finer;
  }
  for (auto& vertex : mesh.vertices)
    vertex *= radius;
  return mesh;
}

/// Four corners, counter-clockwise from outside.
inline void appendQuad(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d)
{
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

/// A tube about the z axis, between z = 0 and its height, with so many flat sides.
inline TriangleMesh tubeMesh(float outer_radius, float inner_radius, float height, int sides)
{
  TriangleMesh mesh;
  for (int k = 0; k < sides; ++k)
  {
    const auto angle = static_cast<float>(2 * M_PI * k / sides);
    for (const float radius : {outer_radius, inner_radius})
      for (const float z : {0.0f, height})
        mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  const auto count = static_cast<std::uint32_t>(sides);
  for (std::uint32_t k = 0; k < count; ++k)
  {
    const std::uint32_t a = 4 * k;  // outer low, outer high, inner low, inner high
    const std::uint32_t b = 4 * ((k + 1) % count);
    appendQuad(mesh, a, b, b + 1, a + 1);
    appendQuad(mesh, a + 2, a + 3, b + 3, b + 2);
    appendQuad(mesh, a + 1, b + 1, b + 3, a + 3);
    appendQuad(mesh, a, a + 2, b + 2, b);
  }
  return mesh;
}

/// An angle of two legs along x and y with the outer edge on the z axis, between z = 0 and its width.
inline TriangleMesh angleMesh(float leg, float thickness, float width)
{
  TriangleMesh mesh;
  for (const float z : {0.0f, width})
    for (const auto& [x, y] : {std::pair<float, float>{0, 0},
                               {leg, 0},
                               {leg, thickness},
                               {thickness, thickness},
                               {thickness, leg},
                               {0, leg}})
      mesh.vertices.emplace_back(x, y, z);
  appendQuad(mesh, 0, 3, 2, 1);
  appendQuad(mesh, 0, 5, 4, 3);
  appendQuad(mesh, 6, 7, 8, 9);
  appendQuad(mesh, 6, 9, 10, 11);
  for (std::uint32_t k = 0; k < 6; ++k)
    appendQuad(mesh, k, (k + 1) % 6, (k + 1) % 6 + 6, k + 6);
  return mesh;
}

inline TriangleMesh moved(TriangleMesh mesh, const Pose& T)
{
  for (Eigen::Vector3f& vertex : mesh.vertices)
    vertex = (T * vertex.cast<double>()).cast<float>();
  return mesh;
}

inline std::string binaryStl(const TriangleMesh& mesh, const std::string& title)
{
  std::string file = title;
  file.resize(80, ' ');
  const auto append = [&file](const auto& value) { file.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
  append(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles)
  {
    for (const float normal : {0.0f, 0.0f, 0.0f})
      append(normal);
    for (const std::uint32_t corner : t)
      for (int k = 0; k < 3; ++k)
        append(mesh.vertices[corner][k]);
    append(std::uint16_t{0});
  }
  return file;
}

inline std::string asciiStl(const TriangleMesh& mesh)
{
  std::ostringstream file;
  file << "solid test\n";
  for (const auto& t : mesh.triangles)
  {
    file << "facet normal 0 0 0\n outer loop\n";
    for (const std::uint32_t corner : t)
      file << "  vertex " << mesh.vertices[corner].transpose() << "\n";
    file << " endloop\nendfacet\n";
  }
  file << "endsolid test\n";
  return file.str();
}

inline std::string asciiPly(const TriangleMesh& mesh)
{
  std::ostringstream file;
  file << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << mesh.triangles.size()
       << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const auto& vertex : mesh.vertices)
    file << vertex.transpose() << "\n";
  for (const auto& t : mesh.triangles)
    file << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
  return file.str();
}

inline std::string obj(const TriangleMesh& mesh)
{
  std::ostringstream file;
  for (const auto& vertex : mesh.vertices)
    file << "v " << vertex.transpose() << "\n";
  for (const auto& t : mesh.triangles)
    file << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
  return file.str();
}
}  // namespace test
}  // namespace bin_picking
