// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/common/oriented_points.hpp"

#include <limits>

namespace bin_picking
{
OrientedPoints select(const OrientedPoints& points, const std::vector<int>& indices)
{
  OrientedPoints result;
  result.points.reserve(indices.size());
  result.normals.reserve(indices.size());
  for (const int i : indices)
  {
    const auto k = static_cast<std::size_t>(i);
    result.points.push_back(points.points[k]);
    result.normals.push_back(points.normals[k]);
    if (!points.curvature.empty())
      result.curvature.push_back(points.curvature[k]);
  }
  return result;
}

OrientedPoints transformed(const OrientedPoints& points, const Pose& T)
{
  const Eigen::Isometry3f Tf = T.cast<float>();
  OrientedPoints result = points;
  for (auto& p : result.points)
    p = Tf * p;
  for (auto& n : result.normals)
    n = Tf.linear() * n;
  return result;
}

double boundingBoxDiagonal(const std::vector<Eigen::Vector3f>& points)
{
  if (points.empty())
    return 0;
  Eigen::Vector3f low = points.front();
  Eigen::Vector3f high = points.front();
  for (const auto& p : points)
  {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return static_cast<double>((high - low).norm());
}
}  // namespace bin_picking
