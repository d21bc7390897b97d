// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bin_physics.hpp"
#include "bin_picking_perception/model/part.hpp"
#include "overlap.hpp"

namespace bin_picking
{
namespace test
{
using namespace simulation;

/// Inner size of the usual bin.
inline const Eigen::Vector3d BIN(0.4, 0.3, 0.15);
/// What a resting part may reach into another one, or into the bin.
constexpr double MAX_DEPTH = 0.001;

struct Kind
{
  explicit Kind(TriangleMesh triangles)
      : mesh(std::make_shared<TriangleMesh>(std::move(triangles))),
        overlap(mesh),
        shape(std::make_shared<RigidBodyShape>(makeRigidBodyShape(*mesh)))
  {}

  std::shared_ptr<const TriangleMesh> mesh;
  OverlapShape overlap;
  std::shared_ptr<const RigidBodyShape> shape;
};

/// Made once, it takes half a second.
inline const Kind& demoPart(const std::string& name)
{
  static std::map<std::string, Kind> kinds;
  const auto known = kinds.find(name);
  if (known != kinds.end())
    return known->second;
  const PartDefinition part = loadPart(std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/" + name);
  return kinds.emplace(name, Kind(loadMesh(part.mesh_file, part.mesh_unit))).first->second;
}

inline const Kind& tee() { return demoPart("three_way_tube"); }

/// \param size of the bin
inline BinPhysics binOf(const std::vector<const Kind*>& kinds, const Eigen::Vector3d& size = BIN)
{
  std::vector<std::shared_ptr<const RigidBodyShape>> shapes;
  for (const Kind* kind : kinds)
    shapes.push_back(kind->shape);
  return {shapes, size, PhysicsParameters{}};
}

inline BinPhysics pileOfTees(std::size_t count, std::uint32_t seed, const Eigen::Vector3d& size = BIN)
{
  BinPhysics physics = binOf({&tee()}, size);
  physics.drop(std::vector<int>(count, 0), seed);
  return physics;
}

inline double deepest(const std::vector<Body>& bodies, const std::vector<const Kind*>& kinds)
{
  std::vector<PlacedShape> placed;
  for (const Body& body : bodies)
    placed.push_back({&kinds[static_cast<std::size_t>(body.shape)]->overlap, body.T_bin_object});
  return deepestOverlap(placed, Executor(0)).depth;
}

/// How far a vertex of the true mesh is behind the floor or a wall (which reach up to the rim).
inline double behindWalls(const Body& body, const TriangleMesh& mesh, const Eigen::Vector3d& size)
{
  double farthest = 0;
  for (const Eigen::Vector3f& vertex : mesh.vertices)
  {
    const Eigen::Vector3d p = body.T_bin_object * vertex.cast<double>();
    farthest = std::max(farthest, -p.z());
    if (p.z() < size.z())
      farthest = std::max({farthest, std::abs(p.x()) - size.x() / 2, std::abs(p.y()) - size.y() / 2});
  }
  return farthest;
}

inline void expectSound(const std::vector<Body>& bodies, const std::vector<const Kind*>& kinds,
                        const Eigen::Vector3d& size = BIN)
{
  EXPECT_LE(deepest(bodies, kinds), MAX_DEPTH);
  for (const Body& body : bodies)
  {
    const TriangleMesh& mesh = *kinds[static_cast<std::size_t>(body.shape)]->mesh;
    EXPECT_LE(behindWalls(body, mesh, size), MAX_DEPTH) << body.id;
    EXPECT_TRUE(body.T_bin_object.linear().isUnitary(1e-9));
    EXPECT_GT(body.T_bin_object.linear().determinant(), 0);
  }
}

/// Bit for bit; ids may differ.
inline bool same(const std::vector<Body>& a, const std::vector<Body>& b)
{
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Body& one, const Body& other) {
    return one.shape == other.shape && one.T_bin_object.matrix() == other.T_bin_object.matrix();
  });
}

inline const Body* find(const std::vector<Body>& bodies, int id)
{
  const auto body = std::find_if(bodies.begin(), bodies.end(), [id](const Body& b) { return b.id == id; });
  return body == bodies.end() ? nullptr : &*body;
}
}  // namespace test
}  // namespace bin_picking
