// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "../common/tile_index.hpp"
#include "bin_picking_perception/common/oriented_points.hpp"
#include "neighbourhood.hpp"
#include "quadric_fit.hpp"

namespace bin_picking
{
/// Moments of points about a query: what the fit of a plane needs.
struct PlaneMoments
{
  double count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
};

/// Oriented points, tile by tile and coordinate by coordinate: what lies around a query are few runs of them, and sums
/// over a run are plain loops. Faster than a search tree for the thousands of queries that one cloud gets.
class TiledPoints
{
public:
  /// \param radius of the neighbourhoods that will be asked for, metres
  TiledPoints(const OrientedPoints& points, float radius);

  /// Of the points within the radius whose normals are turned from the query's by no more than min_cosine says.
  PlaneMoments planeMoments(const Eigen::Vector3f& query, const Eigen::Vector3f& normal, float min_cosine) const;

  /// Of the same, those of a quadric. \param frame maps offsets from the query into the frame of the fit
  QuadricMoments quadricMoments(const Eigen::Vector3f& query, const Eigen::Vector3f& normal,
                                const Eigen::Matrix3f& frame, float min_cosine) const;

  /// Calls visit(found) for the same points, as many at a time as a Neighbourhood holds. \param found working memory
  template <typename Visit>
  void forEachNeighbourhood(const Eigen::Vector3f& query, const Eigen::Vector3f& normal, float min_cosine,
                            Neighbourhood& found, const Visit& visit) const
  {
    found.size = 0;
    tiles_.forEachRun(query, radius_, [&](std::size_t begin, std::size_t end) {
      while (begin < end)
      {
        begin = gather(begin, end, query, normal, min_cosine, found);
        if (begin == end)
          break;
        visit(found);
        found.size = 0;
      }
    });
    padWithZeros(found);
    if (found.size > 0)
      visit(found);
  }

private:
  PointPlanes planes() const { return {x_.data(), y_.data(), z_.data(), nx_.data(), ny_.data(), nz_.data()}; }

  /// Appends what lies within the radius. \return where it stopped: at `end`, or earlier because `found` is full
  std::size_t gather(std::size_t begin, std::size_t end, const Eigen::Vector3f& query, const Eigen::Vector3f& normal,
                     float min_cosine, Neighbourhood& found) const;

  float radius_;
  TileIndex tiles_;
  std::vector<float> x_, y_, z_, nx_, ny_, nz_;
};
}  // namespace bin_picking
