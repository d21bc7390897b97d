// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/model/symmetry_search.hpp"

namespace bin_picking
{
namespace
{
constexpr float FAR = 10;  // metres: beyond any part
constexpr int CONTINUOUS_STEPS = 37;

/// Every so many-th of count things, so that a few of them already lie everywhere.
std::vector<int> spread(const std::vector<int>& ordered)
{
  std::vector<int> result;
  result.reserve(ordered.size());
  constexpr std::size_t STRIDE = 61;
  for (std::size_t first = 0; first < STRIDE; ++first)
    for (std::size_t i = first; i < ordered.size(); i += STRIDE)
      result.push_back(ordered[i]);
  return result;
}
}  // namespace

/// The surface as small discs: between the samples, it lies on their tangent planes.
struct SelfComparison::Support
{
  OrientedPoints points;
  KdTree tree;
  float disc;  ///< radius, metres
  float link;  ///< queries nearer than this belong together, metres
};

SelfComparison::SelfComparison(const OrientedPoints& dense, const std::vector<int>& queries, double spacing,
                               double query_spacing)
    : support_(new Support{dense, KdTree(dense.points), static_cast<float>(1.5 * spacing),
                           static_cast<float>(2.5 * query_spacing)}),
      queries_(select(dense, spread(queries)))
{}

SelfComparison::~SelfComparison() = default;

double SelfComparison::distance(const Eigen::Isometry3f& T, std::size_t query) const
{
  const Eigen::Vector3f p = T * queries_.points[query];
  const Eigen::Vector3f n = T.linear() * queries_.normals[query];
  const float nearest = std::sqrt(support_->tree.nearest(p, FAR).squared_distance);
  std::vector<int> around;
  support_->tree.radiusSearch(p, nearest + support_->disc, around);
  float best = FAR;
  for (const int index : around)
  {
    const auto k = static_cast<std::size_t>(index);
    const Eigen::Vector3f offset = p - support_->points.points[k];
    if (support_->points.normals[k].dot(n) < 0)
      continue;  // the other side of a wall
    const float height = support_->points.normals[k].dot(offset);
    const float aside = std::sqrt(std::max(0.0f, offset.squaredNorm() - height * height));
    best = std::min(best, std::hypot(height, std::max(0.0f, aside - support_->disc)));
  }
  return static_cast<double>(best < FAR ? best : nearest);
}

bool SelfComparison::keeps(const Pose& T, double limit) const
{
  const Eigen::Isometry3f motion = T.cast<float>();
  for (std::size_t i = 0; i < queries_.size(); ++i)
    if (distance(motion, i) > limit)
      return false;
  return true;
}

double SelfComparison::largestRegion(const std::vector<Eigen::Vector3f>& points) const
{
  const KdTree tree(points);
  std::vector<bool> known(points.size(), false);
  std::vector<int> queue;
  std::vector<int> around;
  double largest = 0;
  for (std::size_t first = 0; first < points.size(); ++first)
  {
    if (known[first])
      continue;
    known[first] = true;
    queue = {static_cast<int>(first)};
    Eigen::AlignedBox3f box;
    for (std::size_t next = 0; next < queue.size(); ++next)
    {
      const Eigen::Vector3f& p = points[static_cast<std::size_t>(queue[next])];
      box.extend(p);
      tree.radiusSearch(p, support_->link, around);
      for (const int n : around)
        if (!known[static_cast<std::size_t>(n)])
        {
          known[static_cast<std::size_t>(n)] = true;
          queue.push_back(n);
        }
    }
    largest = std::max(largest, static_cast<double>(box.diagonal().norm()));
  }
  return largest;
}

SurfaceMismatch SelfComparison::mismatch(const Pose& T, double tolerance) const
{
  const Eigen::Isometry3f motion = T.cast<float>();
  SurfaceMismatch result;
  std::vector<Eigen::Vector3f> off;
  for (std::size_t i = 0; i < queries_.size(); ++i)
  {
    const double d = distance(motion, i);
    result.deviation = std::max(result.deviation, d);
    if (d > tolerance)
      off.push_back(queries_.points[i]);
  }
  result.share = static_cast<double>(off.size()) / static_cast<double>(std::max<std::size_t>(1, queries_.size()));
  result.region = off.empty() ? 0 : largestRegion(off);
  return result;
}

double largestDeviation(const SelfComparison& surface, const Symmetry& symmetry)
{
  double largest = 0;
  for (const Pose& T : symmetry.sampled(CONTINUOUS_STEPS))
    largest = std::max(largest, surface.mismatch(T, 0).deviation);
  return largest;
}
}  // namespace bin_picking
