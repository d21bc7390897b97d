// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/common/kd_tree.hpp"

#include <algorithm>
#include <nanoflann.hpp>

namespace bin_picking
{
namespace
{
struct PointsAdaptor
{
  std::vector<Eigen::Vector3f> points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t index, std::size_t dimension) const
  {
    return points[index][static_cast<Eigen::Index>(dimension)];
  }
  template <typename BoundingBox>
  bool kdtree_get_bbox(BoundingBox&) const
  {
    return false;
  }
};

/// What nanoflann asks of a set of results: all within a radius, only their indices.
struct IndicesWithin
{
  using DistanceType = float;

  std::vector<int>& indices;
  float squared_radius;

  bool full() const { return true; }
  float worstDist() const { return squared_radius; }
  bool addPoint(float squared_distance, int index)
  {
    if (squared_distance < squared_radius)
      indices.push_back(index);
    return true;
  }
};

using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, PointsAdaptor>, PointsAdaptor, 3, int>;
}  // namespace

struct KdTree::Index
{
  explicit Index(std::vector<Eigen::Vector3f> points)
      : adaptor{std::move(points)}, tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(16))
  {
    tree.buildIndex();
  }
  PointsAdaptor adaptor;
  Tree tree;
};

KdTree::KdTree(std::vector<Eigen::Vector3f> points) : index_(std::make_unique<Index>(std::move(points))) {}
KdTree::~KdTree() = default;
KdTree::KdTree(KdTree&&) noexcept = default;
KdTree& KdTree::operator=(KdTree&&) noexcept = default;

void KdTree::radiusSearch(const Eigen::Vector3f& query, float radius, std::vector<int>& indices) const
{
  indices.clear();
  if (index_->adaptor.points.empty())
    return;
  IndicesWithin found{indices, radius * radius};
  index_->tree.findNeighbors(found, query.data(), nanoflann::SearchParams());
  std::sort(indices.begin(), indices.end());
}

KdTree::Neighbour KdTree::nearest(const Eigen::Vector3f& query, float max_distance) const
{
  Neighbour neighbour;
  if (index_->adaptor.points.empty())
    return neighbour;
  int index = -1;
  float squared_distance = 0;
  nanoflann::KNNResultSet<float, int> result(1);
  result.init(&index, &squared_distance);
  squared_distance = max_distance * max_distance;  // the result set's worst: the search looks no farther
  index_->tree.findNeighbors(result, query.data(), nanoflann::SearchParams());
  if (index >= 0)
    neighbour = {index, squared_distance};
  return neighbour;
}

const std::vector<Eigen::Vector3f>& KdTree::points() const { return index_->adaptor.points; }
}  // namespace bin_picking
