// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "vote_caster.hpp"

#include <algorithm>
#include <cmath>

#include "../common/simd.hpp"

namespace bin_picking
{
namespace
{
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

unsigned bitsToHold(std::size_t number)
{
  unsigned bits = 1;
  while (std::size_t{1} << bits < number)
    ++bits;
  return bits;
}

/// The features that each pair meets, as ranges of ranks. \return how many of `matches` were written
BIN_PICKING_SIMD std::size_t rankPairs(const FeatureTable& table, const std::vector<ScenePair>& pairs, BinRange q1,
                                       TableMatch* matches)
{
  const auto bins = static_cast<std::uint32_t>(table.quantizer().curvature_bins);
  std::size_t count = 0;
  for (const ScenePair& pair : pairs)
  {
    // Keys that differ in q2 only follow each other, and those of all q2 the next q1's.
    const std::uint32_t cell = table.cell(pair.geometric_key);
    const bool all = pair.q2.first == 0 && pair.q2.last + 1u == bins;
    for (std::uint32_t bin = q1.first; bin <= q1.last; ++bin)
    {
      const std::uint32_t first = (cell * bins + bin) * bins + pair.q2.first;
      bin = all ? q1.last : bin;
      const std::uint32_t last = (cell * bins + bin) * bins + pair.q2.last;
      matches[count] = {{table.rank(first), table.rank(last + 1)}, pair.alpha_s};
      count += matches[count].run.size() > 0;
    }
  }
  return count;
}
}  // namespace

SecondPoints::SecondPoints(const FeatureTable& looked_up, const OrientedPoints& points,
                           const std::vector<BinRange>& curvature_bins, double min_distance, float reach)
    : table(looked_up),
      tiles(points.points, reach / 4),
      flat(points, tiles.order()),
      flat_bins(points.size()),
      quantizer(table.quantizer(), min_distance, static_cast<double>(reach))
{
  for (std::size_t k = 0; k < flat_bins.size() && !curvature_bins.empty(); ++k)
    flat_bins[k] = curvature_bins[static_cast<std::size_t>(tiles.order()[k])];
}

VotingScene::VotingScene(const TrainedModel& trained_model, const OrientedPoints& samples,
                         const std::vector<std::uint8_t>& curvature_complete, const OrientedPoints& edge_points,
                         const VotingParameters& voting)
    : model(trained_model),
      points(samples),
      parameters(voting),
      reach(static_cast<float>(voting.max_pair_distance * trained_model.diameter)),
      curvature_bins(curvatureBins(samples, curvature_complete, model.table.quantizer(), voting)),
      surface(model.table, samples, curvature_bins, model.parameters.min_pair_distance, reach),
      edges(model.edge_table, edge_points, {}, model.parameters.min_pair_distance, reach)
{}

VoteCaster::VoteCaster(const VotingScene& scene)
    : scene_(scene),
      num_angles_(static_cast<std::uint32_t>(std::lround(2 * M_PI / scene.model.parameters.d_angle))),
      accumulator_(scene.model.table.references().size(), static_cast<int>(num_angles_))
{}

void VoteCaster::cast(std::size_t reference, VotingStatistics& statistics)
{
  const VotingParameters& parameters = scene_.parameters;
  const bool weighted = scene_.model.parameters.feature == FeatureKind::CurPpf;
  accumulator_.clear();
  castPairs(reference, scene_.surface, scene_.curvature_bins[reference], parameters.max_votes,
            weighted ? parameters.weight : 1, statistics);
  if (parameters.edge_weight > 0)
    castPairs(reference, scene_.edges, {}, 0, parameters.edge_weight, statistics);
  ++statistics.references;
}

void VoteCaster::castPairs(std::size_t reference, const SecondPoints& seconds, BinRange q1, int max_votes, int weight,
                           VotingStatistics& statistics)
{
  statistics.pairs += collectPairs(reference, seconds);
  if (scene_.parameters.skip_repeated)
    dropRepeated(seconds.table);
  findEntries(seconds.table, q1);
  statistics.votes += vote(seconds.table, max_votes, static_cast<std::uint32_t>(weight));
}

/// \return the number of pairs within reach; kept are those with a geometry that the table holds
std::uint64_t VoteCaster::collectPairs(std::size_t reference, const SecondPoints& seconds)
{
  const FeatureTable& table = seconds.table;
  const std::uint32_t no_key = table.quantizer().numGeometricKeys();
  const Eigen::Vector3f& p1 = scene_.points.points[reference];
  const PairOrigin origin(p1, scene_.points.normals[reference]);
  std::uint64_t num_pairs = 0;
  std::size_t num_kept = 0;
  seconds.tiles.forEachRun(p1, scene_.reach, [&](std::size_t begin, std::size_t end) {
    const std::size_t count = end - begin;
    keys_.resize(std::max(keys_.size(), count));
    alphas_.resize(keys_.size());
    pairs_.resize(std::max(pairs_.size(), num_kept + count));
    seconds.quantizer.quantize(origin, seconds.flat, begin, end, keys_.data(), alphas_.data());
    for (std::size_t i = 0; i < count; ++i)
    {
      // Every pair is written, and the next one over it if it does not count: cheaper than a branch nobody can foresee.
      pairs_[num_kept] = {keys_[i], alphas_[i], seconds.flat_bins[begin + i]};
      num_kept += table.hasCell(keys_[i]);
      num_pairs += keys_[i] != no_key;
    }
  });
  pairs_.resize(num_kept);
  return num_pairs;
}

/// Two pairs of one reference with the same feature and the same step of alpha are neighbours that say the same: only
/// the first counts. The multiplication is a bijection, so that equal hashes mean equal pairs (but for tables of more
/// than 10^8 keys, where a vote may get lost).
void VoteCaster::dropRepeated(const FeatureTable& table)
{
  constexpr std::uint32_t GOLDEN = 2654435769u;
  const auto bins = static_cast<std::uint32_t>(table.quantizer().curvature_bins);
  const unsigned bits = bitsToHold(2 * pairs_.size() + 1);
  seen_.assign(std::size_t{1} << bits, 0);
  const std::uint32_t mask = (1u << bits) - 1;
  std::size_t num_kept = 0;
  for (const ScenePair& pair : pairs_)
  {
    const std::uint32_t feature = (pair.geometric_key * bins + pair.q2.first) * bins + pair.q2.last;
    const std::uint32_t hash = std::max((feature * num_angles_ + (pair.alpha_s * num_angles_ >> 16)) * GOLDEN, 1u);
    std::uint32_t place = hash >> (32 - bits);
    while (seen_[place] != 0 && seen_[place] != hash)
      place = (place + 1) & mask;
    pairs_[num_kept] = pair;
    num_kept += seen_[place] == 0;
    seen_[place] = hash;
  }
  pairs_.resize(num_kept);
}

void VoteCaster::findEntries(const FeatureTable& table, BinRange q1)
{
  matches_.resize(pairs_.size() * (q1.last - q1.first + 1u));
  matches_.resize(rankPairs(table, pairs_, q1, matches_.data()));
  // Entries lie scattered in memory and are fetched ahead of their use.
  for (TableMatch& match : matches_)
  {
    match.run = table.run(match.run.begin, match.run.end);
    __builtin_prefetch(table.entries() + match.run.begin);
  }
}

std::uint64_t VoteCaster::vote(const FeatureTable& table, int max_votes, std::uint32_t weight)
{
  const VotingParameters& parameters = scene_.parameters;
  const std::uint32_t longest = parameters.max_bucket > 0 ? static_cast<std::uint32_t>(parameters.max_bucket) : ~0u;
  std::uint64_t all = 0;
  for (const TableMatch& match : matches_)
    all += match.run.size() <= longest ? match.run.size() : 0;
  const double share = max_votes > 0 ? std::min(1.0, max_votes / static_cast<double>(all)) : 1;
  double due = 0.5;
  std::uint64_t votes = 0;
  for (const TableMatch& match : matches_)
  {
    if (match.run.size() > longest || (due += share) < 1)
      continue;
    due -= 1;
    accumulator_.vote(table.entries() + match.run.begin, table.entries() + match.run.end, match.alpha_s, weight);
    votes += match.run.size();
  }
  return votes;
}
}  // namespace bin_picking
