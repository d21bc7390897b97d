// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "compare_with_itself.hpp"

#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/figures.hpp"
#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/model/slight_turn.hpp"
#include "bin_picking_perception/model/symmetry_search.hpp"
#include "bin_picking_perception/model/view_templates.hpp"

namespace bin_picking
{
namespace
{
/// Of the leaf: as much as a mesh of few facets is off the shape that it stands for, and less than any feature that
/// verification resolves.
constexpr double SYMMETRY_TOLERANCE = 0.1;
constexpr double KEPT_BY_RIVALS = 0.35;  // of the leaf
constexpr double MAX_CELLS = 200;        // along the box's diagonal: a fine leaf must not cost gigabytes
constexpr std::size_t MAX_QUERIES = 2000;

DistanceField makeField(const TrainedModel& model)
{
  const double leaf = model.parameters.leaf;
  const double cell = std::max(leaf / 3, boundingBoxDiagonal(model.surface.points) / MAX_CELLS);
  const double band = std::max(1.5 * leaf, 4 * cell);
  const OrientedPoints dense =
      model.mesh.empty() ? model.surface
                         : sampleSurface(model.mesh, cell / 2, static_cast<std::uint32_t>(model.parameters.seed));
  return DistanceField(dense, cell, band);
}

/// The visible surface: what no camera sees breaks no symmetry.
SelfComparison visibleSurface(const TrainedModel& model, const OrientedPoints& dense)
{
  const std::vector<std::uint8_t> seen = seenByAnyView(model.views, model.surface.size());
  const auto num_seen = static_cast<std::size_t>(std::count(seen.begin(), seen.end(), 1));
  const std::size_t stride = num_seen / MAX_QUERIES + 1;
  const KdTree tree(dense.points);
  const double spacing = model.parameters.surface_spacing;
  std::vector<int> queries;
  std::size_t count = 0;
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (seen[i] && count++ % stride == 0)
      // Surface points are means and lie a little inside of what is round; the samples lie on it.
      if (const int nearest = tree.nearest(model.surface.points[i], static_cast<float>(spacing)).index; nearest >= 0)
        queries.push_back(nearest);
  return SelfComparison(dense, queries, spacing / 2, spacing * std::sqrt(static_cast<double>(stride)));
}

/// A person's word counts more than the mesh; where they differ, the person should know.
void checkStated(TrainedModel& model, const SelfComparison& surface, double tolerance)
{
  if (model.symmetry.trivial())
    return;
  const double deviation = largestDeviation(surface, model.symmetry);
  const std::string found = roundedText(1000 * deviation, 2) + " mm";
  const std::string allowed = roundedText(1000 * tolerance, 2) + " mm";
  if (deviation <= tolerance)
    model.remarks.push_back("the symmetry is stated, and the mesh agrees within " + found);
  else
    model.remarks.push_back("the mesh contradicts the stated symmetry: a turn of it moves the surface by up to " +
                            found + ", and at most " + allowed +
                            " is a symmetry; correct the axes in part.yaml, or leave `symmetry` away to have it found");
}
}  // namespace

void compareWithItself(TrainedModel& model, const PartDefinition& definition, const OrientedPoints& dense)
{
  const double leaf = model.parameters.leaf;
  const double tolerance = SYMMETRY_TOLERANCE * leaf;
  model.field = makeField(model);
  const SelfComparison surface = visibleSurface(model, dense);
  model.symmetry = definition.symmetry;
  if (definition.symmetry_stated || !definition.symmetry.trivial())
    checkStated(model, surface, tolerance);
  SymmetryReport report = findSymmetry(surface, model.field, tolerance);
  if (definition.symmetry_stated || !definition.symmetry.trivial())
    report.round = false;
  else
    model.symmetry = report.symmetry;
  for (std::string& sentence : describe(report))
    model.remarks.push_back(std::move(sentence));
  if (!report.round)
    model.near_symmetries =
        findNearSymmetries(model.surface, model.field, surface, model.symmetry, KEPT_BY_RIVALS * leaf,
                           model.parameters.slight_deviation * model.diameter);
  for (std::string& sentence : describeSlightTurns(model))
    model.remarks.push_back(std::move(sentence));
}
}  // namespace bin_picking
