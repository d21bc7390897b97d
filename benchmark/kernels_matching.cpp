// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <numeric>

#include "../src/core/matching/accumulator.hpp"
#include "../src/core/matching/pair_quantizer.hpp"
#include "bin_picking_perception/matching/clustering.hpp"
#include "bin_picking_perception/matching/voting.hpp"
#include "bin_picking_perception/refinement/verification.hpp"
#include "kernels.hpp"

namespace bin_picking::kernels
{
namespace
{
constexpr std::size_t REFERENCES = 100;

/// A pair as voting looks it up.
struct LookedUpPair
{
  std::uint32_t geometric_key;
  std::int16_t q1_bin;
  std::int16_t q2_bin;
  std::uint16_t alpha;
};

void addPair(std::vector<LookedUpPair>& pairs, const OrientedPoints& scene, std::size_t r, std::size_t i,
             const FeatureQuantizer& quantizer)
{
  const PairFeature feature = pairFeature(scene.points[r], scene.normals[r], scene.curvature[r], scene.points[i],
                                          scene.normals[i], scene.curvature[i]);
  const std::int64_t geometric = quantizer.geometricKey(feature);
  if (geometric < 0 || std::isnan(feature.q1) || std::isnan(feature.q2))
    return;
  const Eigen::Vector3f local = alignToLocalFrame(scene.points[r], scene.normals[r]) * scene.points[i];
  pairs.push_back({static_cast<std::uint32_t>(geometric), static_cast<std::int16_t>(quantizer.curvatureBin(feature.q1)),
                   static_cast<std::int16_t>(quantizer.curvatureBin(feature.q2)),
                   toTurnFraction(alphaInLocalFrame(local))});
}

/// Of reference points all over the scene, one vector each.
std::vector<std::vector<LookedUpPair>> makePairs()
{
  const Workbench& bench = workbench();
  const OrientedPoints& scene = bench.scene.samples;
  const double min_distance = bench.model->parameters.min_pair_distance;
  std::vector<std::vector<LookedUpPair>> all;
  for (std::size_t r = 0; r < scene.size(); r += std::max<std::size_t>(1, scene.size() / REFERENCES))
  {
    all.emplace_back();
    for (std::size_t i = 0; i < scene.size(); ++i)
      if (const double distance = static_cast<double>((scene.points[i] - scene.points[r]).norm());
          distance > min_distance && distance < bench.model->diameter)
        addPair(all.back(), scene, r, i, bench.model->table.quantizer());
  }
  return all;
}

const std::vector<std::vector<LookedUpPair>>& pairsOfReferences()
{
  static const std::vector<std::vector<LookedUpPair>> pairs = makePairs();
  return pairs;
}

std::size_t countPairs()
{
  std::size_t count = 0;
  for (const auto& pairs : pairsOfReferences())
    count += pairs.size();
  return count;
}

Accumulator emptyAccumulator()
{
  const TrainedModel& model = *workbench().model;
  return Accumulator(model.table.references().size(),
                     static_cast<int>(std::lround(2 * M_PI / model.parameters.d_angle)));
}

std::uint64_t vote(const std::vector<LookedUpPair>& pairs, const FeatureTable& table, Accumulator& accumulator)
{
  std::uint64_t votes = 0;
  for (const LookedUpPair& pair : pairs)
  {
    const FeatureTable::Run run = table.find(pair.geometric_key, pair.q1_bin, pair.q2_bin);
    accumulator.vote(table.entries() + run.begin, table.entries() + run.end, pair.alpha, 1);
    votes += run.size();
  }
  return votes;
}

/// Features of the pairs of a reference with all samples, near or not.
void pairKeys(benchmark::State& state)
{
  const Workbench& bench = workbench();
  const OrientedPoints& scene = bench.scene.samples;
  std::vector<int> order(scene.size());
  std::iota(order.begin(), order.end(), 0);
  const FlatPoints flat(scene, order);
  const PairQuantizer quantizer(bench.model->table.quantizer(), bench.model->parameters.min_pair_distance,
                                bench.model->diameter);
  std::vector<std::uint32_t> keys(scene.size());
  std::vector<std::uint16_t> alphas(scene.size());
  for (auto _ : state)
  {
    quantizer.quantize(PairOrigin(scene.points[0], scene.normals[0]), flat, 0, scene.size(), keys.data(),
                       alphas.data());
    benchmark::ClobberMemory();
  }
  countPer(state, "pair", scene.size());
}
BENCHMARK(pairKeys)->Unit(benchmark::kMicrosecond);

void tableLookup(benchmark::State& state)
{
  const FeatureTable& table = workbench().model->table;
  for (auto _ : state)
    for (const auto& pairs : pairsOfReferences())
      for (const LookedUpPair& pair : pairs)
        benchmark::DoNotOptimize(table.find(pair.geometric_key, pair.q1_bin, pair.q2_bin));
  countPer(state, "pair", countPairs());
}
BENCHMARK(tableLookup)->Unit(benchmark::kMillisecond);

/// Look-up included: entries are only worth something once they are found.
void lookupAndVotes(benchmark::State& state)
{
  const FeatureTable& table = workbench().model->table;
  Accumulator accumulator = emptyAccumulator();
  std::uint64_t votes = 0;
  for (auto _ : state)
    for (const auto& pairs : pairsOfReferences())
    {
      accumulator.clear();
      votes += vote(pairs, table, accumulator);
    }
  countPer(state, "vote", votes / static_cast<std::uint64_t>(state.iterations()));
}
BENCHMARK(lookupAndVotes)->Unit(benchmark::kMillisecond);

void accumulatorPeaks(benchmark::State& state)
{
  const VotingParameters& parameters = workbench().parameters.voting;
  Accumulator accumulator = emptyAccumulator();
  accumulator.clear();
  vote(pairsOfReferences().front(), workbench().model->table, accumulator);
  for (auto _ : state)
  {
    int left = parameters.peaks_per_reference;
    accumulator.forEachPeak(parameters.sum_adjacent_angles, parameters.min_peak_share, [&](const auto& peak) {
      benchmark::DoNotOptimize(peak);
      return --left > 0;
    });
  }
  countPer(state, "reference", 1);
}
BENCHMARK(accumulatorPeaks)->Unit(benchmark::kMicrosecond);

VotingResult voteInScene()
{
  const Workbench& bench = workbench();
  const SceneSamples& samples = bench.scene.samples;
  std::vector<int> all(samples.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] = static_cast<int>(i);
  return voteForPoses(*bench.model, samples, samples.curvature_complete, bench.scene.edge_points,
                      chooseReferences(all, bench.parameters.voting), bench.parameters.voting, Deadline(0),
                      bench.executor);
}

void voting(benchmark::State& state)
{
  workbench();  // else the first iteration makes it
  VotingStatistics statistics;
  for (auto _ : state)
    statistics = voteInScene().statistics;
  countPer(state, "reference", statistics.references);
  countPer(state, "pair", statistics.pairs);
  countPer(state, "vote", statistics.votes);
}
BENCHMARK(voting)->Unit(benchmark::kMillisecond);

void clustering(benchmark::State& state)
{
  const Workbench& bench = workbench();
  const std::vector<Hypothesis> hypotheses = voteInScene().hypotheses;
  for (auto _ : state)
    benchmark::DoNotOptimize(clusterPoses(hypotheses, *bench.model, bench.parameters.clustering));
  countPer(state, "hypothesis", hypotheses.size());
}
BENCHMARK(clustering)->Unit(benchmark::kMillisecond);

/// One part alone, as a scan without a grid: from points with normals to refined poses; the counters are stages, ms.
void matchOnePart(benchmark::State& state)
{
  const Workbench& bench = workbench();
  const Pose& T = bench.poses.front();
  OrientedPoints scan;
  for (const std::uint32_t i : visiblePoints(*bench.model, T))
  {
    scan.points.push_back((T * bench.model->surface.points[i].cast<double>()).cast<float>());
    scan.normals.push_back((T.linear() * bench.model->surface.normals[i].cast<double>()).cast<float>());
  }
  DetectorParameters parameters = bench.parameters;
  parameters.num_threads = 1;
  const Detector detector({bench.model}, parameters);
  DetectionResult result;
  for (auto _ : state)
    benchmark::DoNotOptimize(result = detector.match(scan, false));
  state.counters["points"] = static_cast<double>(scan.size());
  for (const StageTime& stage : result.timing)
    state.counters[stage.stage] = 1e3 * stage.seconds;
}
BENCHMARK(matchOnePart)->Unit(benchmark::kMillisecond);

/// All pairs, also those that no view sees together: what a pair costs does not depend on that.
void tableBuild(benchmark::State& state)
{
  const Workbench& bench = workbench();
  const TrainedModel& model = *bench.model;
  const std::vector<std::int8_t> classes(model.points.size(), 0);
  PairSelection all;
  all.min_distance = model.parameters.min_pair_distance;
  std::size_t entries = 0;
  for (auto _ : state)
    entries = FeatureTable(model.points, classes, all, model.table.quantizer(), bench.executor).numEntries();
  countPer(state, "pair", entries);
}
BENCHMARK(tableBuild)->Unit(benchmark::kMillisecond);

void training(benchmark::State& state)
{
  const Workbench& bench = workbench();
  for (auto _ : state)
    benchmark::DoNotOptimize(trainPart(bench.part, {}, bench.executor));
  countPer(state, "pair", bench.model->table.numEntries());
}
BENCHMARK(training)->Unit(benchmark::kMillisecond);
}  // namespace
}  // namespace bin_picking::kernels
