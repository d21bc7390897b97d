// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/reference_choice.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "bin_picking_perception/scene/surface_resampling.hpp"
#include "edge_model.hpp"
#include "learn_curvature.hpp"
#include "learn_shape.hpp"

namespace bin_picking
{
namespace
{
constexpr double MIN_SEEN_SHARE = 0.02;  // of the views; what is seen from fewer is inside the part
constexpr std::size_t MIN_MODEL_POINTS = 30;
constexpr double SYMMETRIC_SPACING = 0.7;  // of the matching leaf; nearer images are one point

/// Per surface point the set of views that see it, as bits.
std::vector<std::uint64_t> visibilityBits(const TrainedModel& model, std::size_t words)
{
  std::vector<std::uint64_t> bits(model.surface.size() * words, 0);
  for (std::size_t v = 0; v < model.views.size(); ++v)
    for (const std::uint32_t point : model.views[v].visible)
      bits[point * words + v / 64] |= std::uint64_t{1} << (v % 64);
  return bits;
}

int countBits(const std::uint64_t* bits, std::size_t words)
{
  int count = 0;
  for (std::size_t w = 0; w < words; ++w)
    count += __builtin_popcountll(bits[w]);
  return count;
}

/// Keeps the points of the outer surface, each with the visibility of the surface point next to it.
std::vector<std::uint64_t> keepVisible(OrientedPoints& points, const TrainedModel& model, std::size_t words)
{
  const std::vector<std::uint64_t> surface_bits = visibilityBits(model, words);
  const KdTree tree(model.surface.points);
  const int min_views = std::max(1, static_cast<int>(MIN_SEEN_SHARE * static_cast<double>(model.views.size())));
  std::vector<int> kept;
  std::vector<std::uint64_t> kept_bits;
  std::vector<int> neighbours;
  std::vector<std::uint64_t> bits(words);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    // All surface points of the leaf count, on the same side of the wall.
    tree.radiusSearch(points.points[i], static_cast<float>(model.parameters.matching_leaf * 0.75), neighbours);
    std::fill(bits.begin(), bits.end(), 0);
    for (const int n : neighbours)
      if (model.surface.normals[static_cast<std::size_t>(n)].dot(points.normals[i]) > 0.5f)
        for (std::size_t w = 0; w < words; ++w)
          bits[w] |= surface_bits[static_cast<std::size_t>(n) * words + w];
    if (countBits(bits.data(), words) < min_views)
      continue;
    kept.push_back(static_cast<int>(i));
    kept_bits.insert(kept_bits.end(), bits.begin(), bits.end());
  }
  points = select(points, kept);
  return kept_bits;
}

FeatureQuantizer makeQuantizer(const TrainedModel& model, int curvature_bins)
{
  const TrainingParameters& p = model.parameters;
  FeatureQuantizer quantizer;
  quantizer.distance_step = p.d_dist;
  quantizer.angle_step = p.d_angle;
  quantizer.distance_bins = static_cast<int>(model.diameter / p.d_dist) + 1;
  quantizer.angle_bins = static_cast<int>(std::ceil(M_PI / p.d_angle - 1e-6));
  if (p.feature != FeatureKind::Ppf)
    chooseCurvatureBins(quantizer, model.points.curvature, p.d_cur, curvatureScale(p), curvature_bins);
  return quantizer;
}

std::vector<std::int8_t> classify(TrainedModel& model)
{
  TrainingParameters& p = model.parameters;
  model.classes = p.high_curvature_min > 0 ? CurvatureClasses{p.low_curvature_max, p.high_curvature_min}
                                           : classesFromHistogram(model.points.curvature);
  if (model.classes.low_max >= 0)
  {
    p.low_curvature_max = model.classes.low_max;
    p.high_curvature_min = model.classes.high_min;
  }
  std::vector<std::int8_t> classes(model.points.size(), 0);
  if (p.feature == FeatureKind::CurPpf)
    for (std::size_t i = 0; i < classes.size(); ++i)
      classes[i] = static_cast<std::int8_t>(model.classes.classOf(model.points.curvature[i]));
  return classes;
}

void checkPoints(const TrainedModel& model)
{
  if (model.points.size() < MIN_MODEL_POINTS)
    throw ParameterError("only " + std::to_string(model.points.size()) + " model points are left at a leaf of " +
                         std::to_string(1e3 * model.parameters.matching_leaf) + " mm, but at least " +
                         std::to_string(MIN_MODEL_POINTS) + " are needed; choose a finer leaf");
}

/// \param visibility per point; empty: every pair counts
void buildTable(TrainedModel& model, const std::vector<std::uint64_t>& visibility, std::size_t words,
                int curvature_bins, const Executor& executor)
{
  TrainingParameters& p = model.parameters;
  const std::vector<std::int8_t> classes = classify(model);
  const FeatureQuantizer quantizer = makeQuantizer(model, curvature_bins);
  p.d_cur = quantizer.curvature_step;
  PairSelection selection;
  selection.min_distance = p.min_pair_distance;
  selection.visibility = visibility;
  selection.visibility_words = words;
  if (p.fold_symmetry)
    selection.references = referencesUpToSymmetry(model.points, model.symmetry, SYMMETRIC_SPACING * p.matching_leaf);
  model.table = FeatureTable(model.points, classes, selection, quantizer, executor);
}
}  // namespace

std::shared_ptr<const TrainedModel> trainPart(const PartDefinition& definition, const TrainingParameters& parameters,
                                              const Executor& executor,
                                              const std::function<void(const std::string&)>& progress)
{
  const auto report = [&progress](const std::string& stage) {
    if (progress)
      progress(stage);
  };
  auto model = std::make_shared<TrainedModel>();
  model->name = definition.name;
  model->mesh_hash = hashFile(definition.mesh_file);
  model->parameter_hash = requestHash(definition, parameters);
  const OrientedPoints dense = learnShape(*model, definition, parameters, executor, report);
  const TrainingParameters& p = model->parameters;
  report("normals and curvature");
  model->points = resamplePoints(dense, p.matching_leaf, p.normal_radius, executor);
  const std::size_t words = (model->views.size() + 63) / 64;
  std::vector<std::uint64_t> visibility = keepVisible(model->points, *model, words);
  checkPoints(*model);
  const bool with_views = p.curvature_in_views || p.edge_pairs;
  const std::vector<PartView> views = with_views ? measureViews(*model, executor) : std::vector<PartView>();
  const int curvature_bins = learnCurvature(*model, dense, views, executor);
  if (!p.covisible_pairs)
    visibility.clear();
  report("feature table");
  buildTable(*model, visibility, words, curvature_bins, executor);
  if (p.edge_pairs && !views.empty())
    learnEdges(*model, views, executor);
  return model;
}
}  // namespace bin_picking
