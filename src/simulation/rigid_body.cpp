// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "rigid_body.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <string>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking::simulation
{
namespace
{
/// Integrals of 1, p and p p^T over the solid, as a sum over the tetrahedra from the origin to each triangle.
struct Moments
{
  double volume = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};

Moments momentsOf(const TriangleMesh& mesh, const Eigen::Vector3d& origin)
{
  Moments moments;
  for (const auto& t : mesh.triangles)
  {
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>() - origin;
    const Eigen::Vector3d b = mesh.vertices[t[1]].cast<double>() - origin;
    const Eigen::Vector3d c = mesh.vertices[t[2]].cast<double>() - origin;
    const double volume = a.dot(b.cross(c)) / 6;
    const Eigen::Vector3d sum = a + b + c;
    moments.volume += volume;
    moments.first += volume / 4 * sum;
    moments.second += volume / 20 * (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  return moments;
}

void requireClosed(const TriangleMesh& mesh)
{
  const MeshReport report = inspectMesh(mesh);
  if (report.open_edges > 0 || report.volume <= 0)
    throw ParameterError("the mesh is not closed (" + std::to_string(report.open_edges) +
                         " of its edges do not have "
                         "two triangles), so it has no inside and no mass; close it in the CAD program, or export it "
                         "as a solid");
}
}  // namespace

RigidBodyShape makeRigidBodyShape(const TriangleMesh& mesh)
{
  requireClosed(mesh);
  RigidBodyShape shape;
  const Moments about_origin = momentsOf(mesh, Eigen::Vector3d::Zero());
  shape.volume = about_origin.volume;
  shape.center_of_mass = about_origin.first / about_origin.volume;
  const Eigen::Matrix3d second = momentsOf(mesh, shape.center_of_mass).second;
  shape.inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  shape.pieces = convexPieces(mesh);
  for (const Eigen::Vector3f& vertex : mesh.vertices)
    shape.radius = std::max(shape.radius, (vertex.cast<double>() - shape.center_of_mass).norm());
  return shape;
}
}  // namespace bin_picking::simulation
