// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/scene/edge_points.hpp"
#include "bin_picking_perception/scene/surface_resampling.hpp"
#include "stages.hpp"

namespace bin_picking
{
namespace
{
constexpr int MIN_EDGE_PIXELS = 2;  // of an edge point: one alone may be noise
constexpr double EDGE_NOISE = 3;    // standard deviations that are no drop
}  // namespace

PreparedScene reduceScene(const PointView& raw, const Bin* bin, const TrainedModel& model,
                          const DetectorParameters& parameters, const Executor& executor, StageClock& clock)
{
  PreparedScene scene;
  if (bin)
    scene.bin = *bin;
  scene.reduction = reductionFactor(raw, model.parameters.leaf, parameters.preprocessing);
  scene.surroundings = reduceGrid(raw, scene.reduction, executor);
  clock.lap("reduction");
  scene.grid = scene.surroundings;
  cropToRegion(scene.grid, parameters.input, bin, executor);
  clock.lap("region");
  removeOutliers(scene.grid, parameters.preprocessing, executor);
  clock.lap("outliers");
  return scene;
}

namespace
{
void describeEdges(PreparedScene& scene, const TrainedModel& model, const VotingParameters& voting,
                   const Executor& executor)
{
  const TrainingParameters& trained = model.parameters;
  const double min_drop = MIN_EDGE_DROP * trained.leaf + EDGE_NOISE * scene.noise;
  scene.edges = findDepthEdges(scene.grid, scene.surroundings, scene.runs, min_drop, executor);
  if (voting.edge_weight > 0 && !model.edges.empty())
    scene.edge_points =
        voxelDownsample(edgePoints(scene.grid, scene.normals, scene.edges), trained.matching_leaf, MIN_EDGE_PIXELS);
}
}  // namespace

void describeScene(PreparedScene& scene, const TrainedModel& model, const DetectorParameters& parameters,
                   const Executor& executor, StageClock& clock)
{
  const TrainingParameters& trained = model.parameters;
  scene.runs = connectedRuns(scene.grid, EdgeRule(), executor);
  scene.noise = estimateDepthNoise(scene.grid, scene.runs);
  clock.lap("noise");
  scene.normals = estimateGridNormals(scene.grid, scene.runs, trained.normal_radius, executor);
  clock.lap("normals");
  executor.forEach(2, [&](std::size_t side) {  // neither needs the other
    if (side == 0)
      scene.samples = sampleScene(scene.grid, scene.normals, trained.matching_leaf, parameters.preprocessing);
    else
      describeEdges(scene, model, parameters.voting, executor);
  });
  clock.count("edge points", static_cast<double>(scene.edge_points.size()));
  clock.count("samples", static_cast<double>(scene.samples.size()));
  clock.lap("sampling");
  if (model.table.quantizer().curvature_bins > 1)
    estimateGridCurvature(scene.samples, scene.grid, scene.runs, scene.normals, trained.curvature_measure,
                          trained.curvature_radius, OPPOSITE_WALL_ANGLE, executor);
  clock.lap("curvature");
}

namespace
{
SceneSamples selectSamples(const SceneSamples& samples, const std::vector<int>& indices)
{
  SceneSamples selected;
  static_cast<OrientedPoints&>(selected) = select(samples, indices);
  for (const int i : indices)
  {
    const auto k = static_cast<std::size_t>(i);
    selected.pixel.push_back(samples.pixel[k]);
    if (!samples.curvature_complete.empty())
      selected.curvature_complete.push_back(samples.curvature_complete[k]);
  }
  return selected;
}

/// Sample indices per segment label.
std::vector<std::vector<int>> samplesByLabel(const SceneSamples& samples, int width, const Segmentation& segmentation)
{
  int last = 0;
  for (const auto& segment : segmentation.segments)
    last = std::max(last, segment.label);
  std::vector<std::vector<int>> members(static_cast<std::size_t>(last) + 1);
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    const std::int32_t label = segmentation.labelAt(samples.pixel[i] % width, samples.pixel[i] / width);
    if (label >= 0 && label <= last)
      members[static_cast<std::size_t>(label)].push_back(static_cast<int>(i));
  }
  return members;
}

std::vector<int> allIndices(std::size_t count)
{
  std::vector<int> indices(count);
  for (std::size_t i = 0; i < count; ++i)
    indices[i] = static_cast<int>(i);
  return indices;
}
}  // namespace

std::vector<SearchRegion> planSearch(const PreparedScene& scene, const Segmentation& segmentation,
                                     const std::vector<CandidateTarget>& candidates, const TrainedModel& model,
                                     const DetectorParameters& parameters)
{
  std::vector<SearchRegion> regions;
  const auto members = samplesByLabel(scene.samples, scene.grid.width, segmentation);
  if (parameters.segmentation.veto)
  {
    for (const auto& candidate : candidates)
    {
      SearchRegion region;
      region.samples = selectSamples(scene.samples, members[static_cast<std::size_t>(candidate.label)]);
      region.references = chooseReferences(allIndices(region.samples.size()), parameters.voting);
      region.keep_clusters = 1;  // one candidate target is one part
      region.is_candidate = true;
      regions.push_back(std::move(region));
    }
    return regions;
  }
  // Everything may vote; candidate targets get references of their own on top, so that the parts that lie free are seen
  // well.
  SearchRegion region;
  const std::vector<int> everything =
      spreadReferences(scene.samples.points, model.parameters.matching_leaf, parameters.voting);
  std::set<int> references(everything.begin(), everything.end());
  for (const auto& candidate : candidates)
  {
    const std::vector<int>& own = members[static_cast<std::size_t>(candidate.label)];
    const auto chosen = std::count_if(own.begin(), own.end(), [&](int i) { return references.count(i) > 0; });
    if (chosen >= parameters.voting.min_references)
      continue;
    const auto more = chooseReferences(own, parameters.voting);
    references.insert(more.begin(), more.end());
  }
  region.samples = scene.samples;
  region.references.assign(references.begin(), references.end());
  region.keep_clusters = parameters.clustering.max_clusters;
  regions.push_back(std::move(region));
  return regions;
}

std::vector<Hypothetical> searchPoses(const std::vector<SearchRegion>& regions, const PreparedScene* scene,
                                      const TrainedModel& model, const DetectorParameters& parameters,
                                      const Deadline& deadline, const Executor& executor, StageClock& clock,
                                      bool& partial)
{
  std::vector<Hypothetical> poses;
  const OrientedPoints no_edges;
  const OrientedPoints& edges = scene != nullptr ? scene->edge_points : no_edges;
  std::optional<Glance> glance;
  if (scene != nullptr && parameters.verification.enabled)
    glance.emplace(*scene, model, parameters.verification);
  for (const auto& region : regions)
  {
    VotingResult votes = voteForPoses(model, region.samples, region.samples.curvature_complete, edges,
                                      region.references, parameters.voting, deadline, executor);
    partial = partial || votes.partial;
    clock.count("references", static_cast<double>(votes.statistics.references));
    clock.count("pairs", static_cast<double>(votes.statistics.pairs));
    clock.count("votes", static_cast<double>(votes.statistics.votes));
    clock.count("hypotheses", static_cast<double>(votes.hypotheses.size()));
    clock.lap("voting");
    if (glance)
      votes.hypotheses = keepPromising(
          votes.hypotheses, static_cast<std::size_t>(parameters.clustering.poses_per_reference), *glance, executor);
    clock.lap("glance");
    const auto clusters = clusterPoses(std::move(votes.hypotheses), model, parameters.clustering);
    clock.count("clusters", static_cast<double>(clusters.size()));
    for (std::size_t i = 0; i < clusters.size() && static_cast<int>(i) < region.keep_clusters; ++i)
      poses.push_back({clusters[i].T_camera_object, clusters[i].votes, &region});
    clock.lap("clustering");
  }
  if (glance && parameters.clustering.promising_share < 1)
    poses = keepPromising(poses, parameters.clustering.promising_share, *glance, executor);
  clock.lap("glance");
  return poses;
}
}  // namespace bin_picking
