// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>

#include "bin_picking_perception/model/mesh.hpp"
#include "even_directions.hpp"

namespace bin_picking
{
namespace
{
using IndexPair = std::pair<std::size_t, std::size_t>;

/// Half of them point along z >= 0: both ends of a direction are looked at. The direction of the true diameter is at
/// most 5 degrees from one of them, and the extent along that one is at least cos(5 degrees) of it.
constexpr int NUM_DIRECTIONS = 1000;

IndexPair extremes(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& direction)
{
  IndexPair result(0, 0);
  float low = direction.dot(points[0]);
  float high = low;
  for (std::size_t i = 1; i < points.size(); ++i)
  {
    const float t = direction.dot(points[i]);
    if (t < low)
    {
      low = t;
      result.first = i;
    }
    if (t > high)
    {
      high = t;
      result.second = i;
    }
  }
  return result;
}

std::vector<std::size_t> extremePoints(const std::vector<Eigen::Vector3f>& points)
{
  const std::vector<Eigen::Vector3d> directions = evenDirections(NUM_DIRECTIONS);
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < directions.size() / 2; ++i)
  {
    const IndexPair pair = extremes(points, directions[i].cast<float>());
    indices.push_back(pair.first);
    indices.push_back(pair.second);
  }
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
  return indices;
}
}  // namespace

double largestDistance(const std::vector<Eigen::Vector3f>& points)
{
  if (points.size() < 2)
    return 0;
  const std::vector<std::size_t> candidates = extremePoints(points);
  IndexPair best(0, 0);
  double largest = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    for (std::size_t k = i + 1; k < candidates.size(); ++k)
    {
      const double distance = (points[candidates[i]] - points[candidates[k]]).cast<double>().norm();
      if (distance > largest)
      {
        largest = distance;
        best = {candidates[i], candidates[k]};
      }
    }
  // The extreme points along the best pair are often a better pair; each round is strictly longer, so this ends.
  for (double before = -1; largest > before;)
  {
    before = largest;
    best = extremes(points, (points[best.second] - points[best.first]).normalized());
    largest = std::max(largest, (points[best.second] - points[best.first]).cast<double>().norm());
  }
  return largest;
}
}  // namespace bin_picking
