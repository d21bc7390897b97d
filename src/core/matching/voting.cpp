// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/matching/voting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>

#include "accumulator.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "fast_quantizer.hpp"
#include "tile_index.hpp"

namespace bin_picking
{
void VotingParameters::visit(ParameterVisitor& v)
{
  v.field({"reference_share", "", "share of the scene samples that vote; voting time is proportional to it", 0.001, 1},
          reference_share);
  v.field({"min_references", "", "at least so many reference points (or all samples)", 1, 100000}, min_references);
  v.field({"max_pair_distance", "",
           "reach of a reference point as a share of the diameter; less is faster and less specific", 0.1, 1},
          max_pair_distance);
  v.field({"weight", "", "W of Equation 8, for pairs of a low- and a high-curvature point (the paper: 2 to 8)", 1, 64},
          weight);
  v.field({"curvature_spread", "",
           "share of a curvature bin at either end from which the neighbouring bin is looked up too", 0, 0.5},
          curvature_spread);
  v.field({"curvature_wildcard", "", "points whose neighbourhood is cut off meet every curvature bin"},
          curvature_wildcard);
  v.field({"max_bucket", "", "longer entries of the table are skipped (planes, cylinders); 0 = none", 0, 10000000},
          max_bucket);
  v.field({"peaks_per_reference", "", "most poses that one reference point may propose", 1, 20}, peaks_per_reference);
  v.field({"min_peak_share", "", "further poses of a reference point need this share of its highest vote", 0, 1},
          min_peak_share);
  v.field({"sum_adjacent_angles", "", "count votes of two neighbouring steps of alpha together"}, sum_adjacent_angles);
}

std::vector<int> chooseReferences(const std::vector<int>& candidates, const VotingParameters& parameters)
{
  const auto count = static_cast<double>(candidates.size());
  const double wanted =
      std::min(count, std::max(parameters.reference_share * count, static_cast<double>(parameters.min_references)));
  std::vector<int> references;
  references.reserve(static_cast<std::size_t>(wanted) + 1);
  for (double next = 0; next < count && wanted > 0; next += count / wanted)
    references.push_back(candidates[static_cast<std::size_t>(next)]);
  return references;
}

namespace
{
constexpr std::size_t BATCH = 32;

/// Curvature bins that a scene point is looked up in.
struct BinRange
{
  std::uint8_t first = 0;
  std::uint8_t last = 0;
};

struct Lookup
{
  std::uint32_t key;
  std::uint16_t alpha_s;
};

/// What all references share.
struct Scene
{
  const TrainedModel& model;
  const OrientedPoints& points;
  const VotingParameters& parameters;
  std::vector<BinRange> bins;
  FastQuantizer geometry;
  TileIndex tiles;
  float reach;
};

std::vector<BinRange> curvatureBins(const OrientedPoints& scene, const std::vector<std::uint8_t>& complete,
                                    const FeatureQuantizer& quantizer, const VotingParameters& parameters)
{
  const int last = quantizer.curvature_bins - 1;
  std::vector<BinRange> bins(scene.size());
  for (std::size_t i = 0; i < scene.size() && last > 0; ++i)
  {
    const float q = scene.curvature[i];
    const bool known = !std::isnan(q) && (complete.empty() || complete[i] || !parameters.curvature_wildcard);
    if (!known)
    {
      bins[i] = {0, static_cast<std::uint8_t>(last)};
      continue;
    }
    const int bin = quantizer.curvatureBin(q);
    const double fraction = quantizer.curvatureFraction(q);
    bins[i].first = static_cast<std::uint8_t>(std::max(0, bin - (fraction < parameters.curvature_spread)));
    bins[i].last = static_cast<std::uint8_t>(std::min(last, bin + (fraction > 1 - parameters.curvature_spread)));
  }
  return bins;
}

/// Features of the pairs of one reference point, as keys.
std::size_t collectLookups(const Scene& scene, std::size_t reference, std::vector<Lookup>& lookups)
{
  lookups.clear();
  std::size_t pairs = 0;
  const FeatureQuantizer& quantizer = scene.model.table.quantizer();
  const Eigen::Vector3f& p1 = scene.points.points[reference];
  const Eigen::Vector3f& n1 = scene.points.normals[reference];
  const Eigen::Matrix3f R_local_camera = alignToLocalFrame(p1, n1).linear();
  const Eigen::Vector3f to_y = R_local_camera.row(1);
  const Eigen::Vector3f to_z = R_local_camera.row(2);
  const float squared_reach = scene.reach * scene.reach;
  const auto min_distance = static_cast<float>(scene.model.parameters.min_pair_distance);
  const float squared_min = min_distance * min_distance;
  scene.tiles.forEachNear(p1, scene.reach, [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    const Eigen::Vector3f d = scene.points.points[i] - p1;
    const float squared_distance = d.squaredNorm();
    if (i == reference || squared_distance > squared_reach || squared_distance < squared_min)
      return;
    const Eigen::Vector3f& n2 = scene.points.normals[i];
    const float distance = std::sqrt(squared_distance);
    const std::int64_t geometric =
        scene.geometry.geometricKey(distance, n1.dot(d) / distance, n2.dot(d) / distance, n1.dot(n2));
    if (geometric < 0)
      return;
    ++pairs;
    const std::uint16_t alpha_s = turnFraction(-to_z.dot(d), to_y.dot(d));  // alphaInLocalFrame
    for (int q1 = scene.bins[reference].first; q1 <= scene.bins[reference].last; ++q1)
      for (int q2 = scene.bins[i].first; q2 <= scene.bins[i].last; ++q2)
        lookups.push_back({quantizer.key(geometric, q1, q2), alpha_s});
  });
  return pairs;
}

std::uint64_t castVotes(const Scene& scene, const std::vector<Lookup>& lookups, Accumulator& accumulator)
{
  const FeatureTable& table = scene.model.table;
  const std::uint32_t longest =
      scene.parameters.max_bucket > 0 ? static_cast<std::uint32_t>(scene.parameters.max_bucket) : ~0u;
  const bool weighted = scene.model.parameters.feature == FeatureKind::CurPpf;
  const std::uint32_t weight = weighted ? static_cast<std::uint32_t>(scene.parameters.weight) : 1;
  std::uint64_t votes = 0;
  // Both the slots and the entries behind them lie scattered in memory. They are fetched a batch ahead of their use.
  struct Run
  {
    FeatureTable::Slot slot;
    std::uint16_t alpha_s;
  };
  std::array<Run, BATCH> runs;
  for (std::size_t begin = 0; begin < lookups.size(); begin += BATCH)
  {
    const std::size_t end = std::min(lookups.size(), begin + BATCH);
    for (std::size_t i = end; i < std::min(lookups.size(), end + BATCH); ++i)
      table.prefetch(lookups[i].key);
    std::size_t num_runs = 0;
    for (std::size_t i = begin; i < end; ++i)
    {
      const FeatureTable::Slot slot = table.find(lookups[i].key);
      if (slot.count == 0 || slot.count > longest)
        continue;
      __builtin_prefetch(table.entries() + slot.begin);
      runs[num_runs++] = {slot, lookups[i].alpha_s};
    }
    for (std::size_t i = 0; i < num_runs; ++i)
    {
      accumulator.vote(table.entries() + runs[i].slot.begin, runs[i].slot.count, runs[i].alpha_s, weight);
      votes += runs[i].slot.count;
    }
  }
  return votes;
}

bool samePose(const Pose& a, const Pose& b, const TrainedModel& model)
{
  constexpr double SAME_ANGLE = 0.5;
  return (a * model.center - b * model.center).norm() < 0.1 * model.diameter &&
         Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() < SAME_ANGLE;
}

/// The strongest peaks that are different poses (Equation 6).
std::vector<Hypothesis> extractPoses(const Scene& scene, std::size_t reference, const Accumulator& accumulator)
{
  const TrainedModel& model = scene.model;
  const Pose T_camera_local =
      alignToLocalFrame(scene.points.points[reference], scene.points.normals[reference]).cast<double>().inverse();
  std::vector<Hypothesis> hypotheses;
  for (const auto& peak : accumulator.peaks(scene.parameters.sum_adjacent_angles, scene.parameters.min_peak_share))
  {
    const auto m = static_cast<std::size_t>(peak.model_point);
    const Pose T_local_object = alignToLocalFrame(model.points.points[m], model.points.normals[m]).cast<double>();
    const Pose T_camera_object =
        T_camera_local * Eigen::AngleAxisd(static_cast<double>(peak.alpha), Eigen::Vector3d::UnitX()) * T_local_object;
    const bool known = std::any_of(hypotheses.begin(), hypotheses.end(), [&](const Hypothesis& other) {
      return samePose(other.T_camera_object, T_camera_object, model);
    });
    if (known)
      continue;
    hypotheses.push_back({T_camera_object, peak.votes, static_cast<int>(reference), peak.model_point});
    if (static_cast<int>(hypotheses.size()) == scene.parameters.peaks_per_reference)
      break;
  }
  return hypotheses;
}

/// Accumulators are large; threads take one and give it back.
class AccumulatorPool
{
public:
  AccumulatorPool(std::size_t rows, int angles) : rows_(rows), angles_(angles) {}

  std::unique_ptr<Accumulator> take()
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (free_.empty())
      return std::make_unique<Accumulator>(rows_, angles_);
    auto accumulator = std::move(free_.back());
    free_.pop_back();
    return accumulator;
  }
  void giveBack(std::unique_ptr<Accumulator> accumulator)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    free_.push_back(std::move(accumulator));
  }

private:
  std::size_t rows_;
  int angles_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Accumulator>> free_;
};

struct BlockResult
{
  std::vector<Hypothesis> hypotheses;
  VotingStatistics statistics;
  bool skipped = false;
};
}  // namespace

VotingResult voteForPoses(const TrainedModel& model, const OrientedPoints& points,
                          const std::vector<std::uint8_t>& curvature_complete, const std::vector<int>& references,
                          const VotingParameters& parameters, const Deadline& deadline, const Executor& executor)
{
  const auto reach = static_cast<float>(parameters.max_pair_distance * model.diameter);
  const Scene scene{model,
                    points,
                    parameters,
                    curvatureBins(points, curvature_complete, model.table.quantizer(), parameters),
                    FastQuantizer(model.table.quantizer()),
                    TileIndex(points.points, reach / 4),
                    reach};
  const auto num_angles = static_cast<int>(std::lround(2 * M_PI / model.parameters.d_angle));
  AccumulatorPool pool(model.points.size(), num_angles);

  constexpr std::size_t BLOCK = 8;
  std::vector<BlockResult> blocks((references.size() + BLOCK - 1) / BLOCK);
  executor.forEach(blocks.size(), [&](std::size_t b) {
    BlockResult& result = blocks[b];
    result.skipped = deadline.passed();
    if (result.skipped)
      return;
    auto accumulator = pool.take();
    std::vector<Lookup> lookups;
    for (std::size_t r = b * BLOCK; r < std::min(references.size(), (b + 1) * BLOCK); ++r)
    {
      const auto reference = static_cast<std::size_t>(references[r]);
      accumulator->clear();
      result.statistics.pairs += collectLookups(scene, reference, lookups);
      result.statistics.votes += castVotes(scene, lookups, *accumulator);
      ++result.statistics.references;
      const auto poses = extractPoses(scene, reference, *accumulator);
      result.hypotheses.insert(result.hypotheses.end(), poses.begin(), poses.end());
    }
    pool.giveBack(std::move(accumulator));
  });

  VotingResult result;
  for (const auto& block : blocks)
  {
    result.hypotheses.insert(result.hypotheses.end(), block.hypotheses.begin(), block.hypotheses.end());
    result.statistics.references += block.statistics.references;
    result.statistics.pairs += block.statistics.pairs;
    result.statistics.votes += block.statistics.votes;
    result.partial = result.partial || block.skipped;
  }
  return result;
}
}  // namespace bin_picking
