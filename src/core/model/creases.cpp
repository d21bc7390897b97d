// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "creases.hpp"

#include <algorithm>

#include "bin_picking_perception/common/kd_tree.hpp"

namespace bin_picking
{
std::vector<std::uint8_t> nearCrease(const OrientedPoints& surface, double radius, const Executor& executor)
{
  constexpr float UNBENT = 0.97f;      // cosine between a point's normal and the mean around it
  constexpr float OTHER_SIDE = -0.3f;  // of a thin wall: the camera never sees both
  const KdTree tree(surface.points);
  std::vector<std::uint8_t> near(surface.size(), 0);
  constexpr std::size_t BLOCK = 256;
  executor.forEach((surface.size() + BLOCK - 1) / BLOCK, [&](std::size_t block) {
    std::vector<int> neighbours;
    for (std::size_t i = block * BLOCK; i < std::min(surface.size(), (block + 1) * BLOCK); ++i)
    {
      tree.radiusSearch(surface.points[i], static_cast<float>(radius), neighbours);
      Eigen::Vector3f mean = Eigen::Vector3f::Zero();  // of a smooth surface, however curved, it is the normal itself
      for (const int n : neighbours)
        if (surface.normals[i].dot(surface.normals[static_cast<std::size_t>(n)]) > OTHER_SIDE)
          mean += surface.normals[static_cast<std::size_t>(n)];
      near[i] = mean.dot(surface.normals[i]) < UNBENT * mean.norm();
    }
  });
  return near;
}
}  // namespace bin_picking
