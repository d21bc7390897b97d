// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "edge_model.hpp"

#include <cmath>

#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/scene/surface_resampling.hpp"

namespace bin_picking
{
namespace
{
constexpr float SAME_DIRECTION = 0.866f;  // cosine of 30 degrees
constexpr int MIN_VIEWS = 4;              // an edge of a single view may be chance, ...
constexpr int MIN_PIXELS = 8;             // ... and so may a few pixels of all views together
constexpr int ANGLE_BINS = 9;             // of 20 degrees: edges are measured less well than normals

/// The views that show each edge, as bits.
std::vector<std::uint64_t> viewsOfEdges(const OrientedPoints& edges, double leaf, const std::vector<PartView>& views)
{
  std::vector<std::uint64_t> bits(edges.size(), 0);
  const KdTree tree(edges.points);
  std::vector<int> near;
  for (std::size_t v = 0; v < views.size(); ++v)
    for (std::size_t k = 0; k < views[v].edges.size(); ++k)
    {
      tree.radiusSearch(views[v].edges.points[k], static_cast<float>(leaf / 2), near);
      for (const int i : near)
        if (edges.normals[static_cast<std::size_t>(i)].dot(views[v].edges.normals[k]) > SAME_DIRECTION)
          bits[static_cast<std::size_t>(i)] |= std::uint64_t{1} << v;
    }
  return bits;
}

std::vector<std::uint64_t> viewsOfPoints(std::size_t num_points, const std::vector<PartView>& views)
{
  std::vector<std::uint64_t> bits(num_points, 0);
  for (std::size_t v = 0; v < views.size(); ++v)
    for (const std::size_t i : views[v].points)
      bits[i] |= std::uint64_t{1} << v;
  return bits;
}

OrientedPoints allEdges(const std::vector<PartView>& views)
{
  OrientedPoints all;
  for (const PartView& view : views)
  {
    all.points.insert(all.points.end(), view.edges.points.begin(), view.edges.points.end());
    all.normals.insert(all.normals.end(), view.edges.normals.begin(), view.edges.normals.end());
  }
  return all;
}
}  // namespace

void learnEdges(TrainedModel& model, const std::vector<PartView>& views, const Executor& executor)
{
  const double leaf = model.parameters.matching_leaf;
  const OrientedPoints edges = voxelDownsample(allEdges(views), leaf, MIN_PIXELS);
  const std::vector<std::uint64_t> bits = viewsOfEdges(edges, leaf, views);
  PairSelection selection;
  std::vector<int> kept;
  for (std::size_t i = 0; i < edges.size(); ++i)
    if (__builtin_popcountll(bits[i]) >= MIN_VIEWS)
    {
      kept.push_back(static_cast<int>(i));
      selection.second_visibility.push_back(bits[i]);
    }
  model.edges = select(edges, kept);
  selection.min_distance = model.parameters.min_pair_distance;
  selection.visibility = viewsOfPoints(model.points.size(), views);
  selection.visibility_words = 1;
  selection.references = model.table.references();
  FeatureQuantizer quantizer = model.table.quantizer();
  quantizer.curvature_bins = 1;
  quantizer.angle_bins = ANGLE_BINS;
  quantizer.angle_step = M_PI / ANGLE_BINS;
  model.edge_table = FeatureTable(model.points, model.edges, selection, quantizer, executor);
}
}  // namespace bin_picking
