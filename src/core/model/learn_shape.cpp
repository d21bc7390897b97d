// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "learn_shape.hpp"

#include <algorithm>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/view_templates.hpp"
#include "bin_picking_perception/scene/surface_resampling.hpp"
#include "compare_with_itself.hpp"
#include "creases.hpp"

namespace bin_picking
{
namespace
{
constexpr double AUTOMATIC_LEAF_SHARE = 0.04;       // of the diameter
constexpr double AUTOMATIC_MATCHING_SHARE = 0.065;  // of the diameter
constexpr double MAX_AUTOMATIC_LEAF = 0.006;        // large parts have small features too, ...
constexpr double MIN_LEAF_SHARE = 0.015;            // ... but the table has a limit

/// Replaces every "automatic" length by its value for a part of this diameter.
void resolve(TrainingParameters& p, double diameter)
{
  const auto automatic = [](double& value, double derived) { value = value > 0 ? value : derived; };
  automatic(p.leaf, std::min(AUTOMATIC_LEAF_SHARE * diameter, std::max(MAX_AUTOMATIC_LEAF, MIN_LEAF_SHARE * diameter)));
  automatic(p.matching_leaf, std::max(p.leaf, AUTOMATIC_MATCHING_SHARE * diameter));
  automatic(p.surface_spacing, p.leaf / 2);
  automatic(p.normal_radius, 1.3 * p.leaf);
  automatic(p.curvature_radius, p.leaf * 10 / 3);
  automatic(p.d_dist, 0.6 * p.matching_leaf);
  automatic(p.min_pair_distance, 1.5 * p.matching_leaf);
  if (std::max(p.leaf, p.matching_leaf) > diameter / 5)
    throw ParameterError("the leaf is " + std::to_string(1e3 * std::max(p.leaf, p.matching_leaf)) +
                         " mm, but the part is only " + std::to_string(1e3 * diameter) +
                         " mm across; at most a fifth of that is useful (is the unit right?)");
}

/// The part's surface, dense enough for normals and curvature.
OrientedPoints denseSurface(const PartDefinition& definition, TrainedModel& model)
{
  if (isPointModel(definition.mesh_file))
  {
    OrientedPoints points = loadOrientedPoints(definition.mesh_file, definition.mesh_unit);
    model.diameter = largestDistance(points.points);
    resolve(model.parameters, model.diameter);
    return points;
  }
  model.mesh = loadMesh(definition.mesh_file, definition.mesh_unit);
  checkExpectedSize(definition, inspectMesh(model.mesh).size);
  model.diameter = largestDistance(model.mesh.vertices);
  resolve(model.parameters, model.diameter);
  const double spacing = std::min(model.parameters.surface_spacing, model.parameters.leaf / 2) / 2;
  return sampleSurface(model.mesh, spacing, static_cast<std::uint32_t>(model.parameters.seed));
}

void measureSize(TrainedModel& model, const OrientedPoints& dense)
{
  Eigen::Vector3f low = dense.points.front();
  Eigen::Vector3f high = low;
  for (const auto& p : dense.points)
  {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  model.size = (high - low).cast<double>();
  model.center = (high + low).cast<double>() / 2;
}
}  // namespace

OrientedPoints learnShape(TrainedModel& model, const PartDefinition& definition, const TrainingParameters& parameters,
                          const Executor& executor, const std::function<void(const std::string&)>& report)
{
  model.parameters = parameters;
  setParametersFromYaml(visitor(model.parameters), definition.training_yaml, definition.directory + "/part.yaml");
  report("surface");
  OrientedPoints dense = denseSurface(definition, model);
  const TrainingParameters& p = model.parameters;
  measureSize(model, dense);
  model.surface = voxelDownsample(dense, p.surface_spacing);
  report("views");
  model.views = renderViewTemplates(model.mesh, model.surface, p.surface_spacing / 2, p.num_views, executor);
  model.near_crease = nearCrease(model.surface, p.normal_radius, executor);
  report("symmetry");
  compareWithItself(model, definition, dense);
  return dense;
}

Symmetry symmetryOf(const PartDefinition& definition, const Executor& executor)
{
  if (definition.symmetry_stated || !definition.symmetry.trivial())
    return definition.symmetry;
  TrainedModel model;
  learnShape(model, definition, TrainingParameters(), executor, [](const std::string&) {});
  return model.symmetry;
}
}  // namespace bin_picking
