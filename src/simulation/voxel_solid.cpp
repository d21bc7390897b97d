// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "voxel_solid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh_solid.hpp"

namespace bin_picking::simulation
{
namespace
{
constexpr float FAR = 1e12f;  // squared edges; large, but its sums stay exact enough to compare

/// Squared distance along one line: lower envelope of parabolas (Felzenszwalb and Huttenlocher 2012).
void transformLine(std::vector<float>& values, std::vector<int>& roots, std::vector<float>& starts)
{
  const int n = static_cast<int>(values.size());
  const auto at = [&](int q) { return values[static_cast<std::size_t>(q)]; };
  roots.assign(1, 0);
  starts.assign(1, -std::numeric_limits<float>::infinity());
  for (int q = 1; q < n; ++q)
  {
    const auto meet = [&](int r) {
      return (at(q) - at(r) + static_cast<float>(q * q - r * r)) / static_cast<float>(2 * (q - r));
    };
    while (roots.size() > 1 && meet(roots.back()) <= starts.back())
    {
      roots.pop_back();
      starts.pop_back();
    }
    starts.push_back(meet(roots.back()));
    roots.push_back(q);
  }
  std::vector<float> out(values.size());
  std::size_t k = 0;
  for (int q = 0; q < n; ++q)
  {
    while (k + 1 < roots.size() && starts[k + 1] < static_cast<float>(q))
      ++k;
    const int r = roots[k];
    out[static_cast<std::size_t>(q)] = static_cast<float>((q - r) * (q - r)) + at(r);
  }
  values.swap(out);
}
}  // namespace

VoxelSolid::VoxelSolid(const TriangleMesh& mesh, int resolution)
{
  Eigen::Vector3d low = mesh.vertices[0].cast<double>();
  Eigen::Vector3d high = low;
  for (const Eigen::Vector3f& p : mesh.vertices)
  {
    low = low.cwiseMin(p.cast<double>());
    high = high.cwiseMax(p.cast<double>());
  }
  edge_ = (high - low).maxCoeff() / resolution;
  size_ = ((high - low) / edge_).array().ceil().cast<int>().max(1);
  origin_ = 0.5 * (low + high) - 0.5 * edge_ * size_.cast<double>();
  fill(mesh);
  measureDistances();
}

void VoxelSolid::fill(const TriangleMesh& mesh)
{
  inside_.assign(static_cast<std::size_t>(size_.prod()), 0);
  const SolidTest solid(mesh);
  Eigen::Vector3i cube;
  for (cube.z() = 0; cube.z() < size_.z(); ++cube.z())
    for (cube.y() = 0; cube.y() < size_.y(); ++cube.y())
    {
      cube.x() = 0;
      const std::vector<double> surface = solid.crossings(center(cube).y(), center(cube).z());
      for (; cube.x() < size_.x(); ++cube.x())
      {
        const auto before = std::lower_bound(surface.begin(), surface.end(), center(cube).x()) - surface.begin();
        inside_[index(cube)] = static_cast<std::uint8_t>(before % 2);
      }
    }
}

void VoxelSolid::measureDistances()
{
  distance_.resize(inside_.size());
  for (std::size_t i = 0; i < inside_.size(); ++i)
    distance_[i] = inside_[i] ? 0 : FAR;
  std::vector<float> line;
  std::vector<int> roots;
  std::vector<float> starts;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    line.resize(static_cast<std::size_t>(size_[axis]));
    for (Eigen::Vector3i cube(0, 0, 0); cube[v] < size_[v]; ++cube[v])
      for (cube[u] = 0; cube[u] < size_[u]; ++cube[u])
      {
        for (cube[axis] = 0; cube[axis] < size_[axis]; ++cube[axis])
          line[static_cast<std::size_t>(cube[axis])] = distance_[index(cube)];
        transformLine(line, roots, starts);
        for (cube[axis] = 0; cube[axis] < size_[axis]; ++cube[axis])
          distance_[index(cube)] = line[static_cast<std::size_t>(cube[axis])];
        cube[axis] = 0;
      }
  }
  for (float& value : distance_)
    value = std::sqrt(value);
}
}  // namespace bin_picking::simulation
