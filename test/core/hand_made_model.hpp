// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "analytic_surfaces.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/reference_choice.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "bin_picking_perception/scene/surface_resampling.hpp"

namespace bin_picking
{
namespace test
{
/// A model made straight from surface points: no views, every pair stored (up to the symmetry).
inline TrainedModel modelOf(const OrientedPoints& dense, double leaf, FeatureKind feature,
                            const Symmetry& symmetry = Symmetry())
{
  TrainedModel model;
  model.name = "test part";
  model.parameters.leaf = leaf;
  model.parameters.matching_leaf = leaf;
  model.parameters.normal_radius = 1.3 * leaf;
  model.parameters.curvature_radius = 3.3 * leaf;
  model.parameters.min_pair_distance = leaf;
  model.parameters.feature = feature;
  model.parameters.d_dist = 0.6 * leaf;
  model.points = resampleSurface(dense, {leaf, 1.3 * leaf, CurvatureMeasure::MeanCurvature, 3.3 * leaf}, Executor(1));
  model.surface = voxelDownsample(dense, leaf / 2);
  model.diameter = boundingBoxDiagonal(dense.points);
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  for (const auto& p : dense.points)
    mean += p / static_cast<float>(dense.size());
  model.center = mean.cast<double>();

  FeatureQuantizer quantizer;
  quantizer.distance_step = model.parameters.d_dist;
  quantizer.distance_bins = static_cast<int>(model.diameter / model.parameters.d_dist) + 1;
  if (feature != FeatureKind::Ppf)
    chooseCurvatureBins(quantizer, model.points.curvature, 0, 1 / (3.3 * leaf));
  model.classes = classesFromHistogram(model.points.curvature);
  std::vector<std::int8_t> classes(model.points.size(), 0);
  for (std::size_t i = 0; i < classes.size() && feature == FeatureKind::CurPpf; ++i)
    classes[i] = static_cast<std::int8_t>(model.classes.classOf(model.points.curvature[i]));
  PairSelection selection;
  selection.min_distance = leaf;
  selection.references = referencesUpToSymmetry(model.points, symmetry, 0.7 * leaf);
  model.symmetry = symmetry;
  model.table = FeatureTable(model.points, classes, selection, quantizer, Executor(1));
  return model;
}

inline std::vector<int> everyIndex(std::size_t count)
{
  std::vector<int> indices(count);
  for (std::size_t i = 0; i < count; ++i)
    indices[i] = static_cast<int>(i);
  return indices;
}
}  // namespace test
}  // namespace bin_picking
