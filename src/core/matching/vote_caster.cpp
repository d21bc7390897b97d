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
                                    const std::vector<int>& order, const FeatureQuantizer& quantizer,
                                    const VotingParameters& parameters)
{
  const int last = quantizer.curvature_bins - 1;
  std::vector<BinRange> bins(order.size());
  for (std::size_t k = 0; k < order.size() && last > 0; ++k)
  {
    const auto i = static_cast<std::size_t>(order[k]);
    const float q = scene.curvature[i];
    const bool known = !std::isnan(q) && (complete.empty() || complete[i] || !parameters.curvature_wildcard);
    if (!known)
    {
      bins[k] = {0, static_cast<std::uint8_t>(last)};
      continue;
    }
    const int bin = quantizer.curvatureBin(q);
    const double fraction = quantizer.curvatureFraction(q);
    bins[k].first = static_cast<std::uint8_t>(std::max(0, bin - (fraction < parameters.curvature_spread)));
    bins[k].last = static_cast<std::uint8_t>(std::min(last, bin + (fraction > 1 - parameters.curvature_spread)));
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

std::vector<std::uint32_t> inverse(const std::vector<int>& order)
{
  std::vector<std::uint32_t> places(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    places[static_cast<std::size_t>(order[k])] = static_cast<std::uint32_t>(k);
  return places;
}
}  // namespace

VotingScene::VotingScene(const TrainedModel& trained_model, const OrientedPoints& samples,
                         const std::vector<std::uint8_t>& curvature_complete, const VotingParameters& voting)
    : model(trained_model),
      points(samples),
      parameters(voting),
      reach(static_cast<float>(voting.max_pair_distance * trained_model.diameter)),
      tiles(samples.points, reach / 4),
      flat(samples, tiles.order()),
      flat_bins(curvatureBins(samples, curvature_complete, tiles.order(), model.table.quantizer(), voting)),
      places(inverse(tiles.order())),
      quantizer(model.table.quantizer(), model.parameters.min_pair_distance, static_cast<double>(reach))
{}

VoteCaster::VoteCaster(const VotingScene& scene)
    : scene_(scene),
      num_angles_(static_cast<std::uint32_t>(std::lround(2 * M_PI / scene.model.parameters.d_angle))),
      accumulator_(scene.model.table.references().size(), static_cast<int>(num_angles_))
{}

void VoteCaster::cast(std::size_t reference, VotingStatistics& statistics)
{
  accumulator_.clear();
  statistics.pairs += collectPairs(reference);
  if (scene_.parameters.skip_repeated)
    dropRepeated();
  findEntries(scene_.flat_bins[scene_.places[reference]]);
  statistics.votes += vote();
  ++statistics.references;
}

/// \return the number of pairs within reach; kept are those with a geometry that the table holds
std::uint64_t VoteCaster::collectPairs(std::size_t reference)
{
  const FeatureTable& table = scene_.model.table;
  const std::uint32_t no_key = table.quantizer().numGeometricKeys();
  const Eigen::Vector3f& p1 = scene_.points.points[reference];
  const PairOrigin origin(p1, scene_.points.normals[reference]);
  std::uint64_t num_pairs = 0;
  std::size_t num_kept = 0;
  scene_.tiles.forEachRun(p1, scene_.reach, [&](std::size_t begin, std::size_t end) {
    const std::size_t count = end - begin;
    keys_.resize(std::max(keys_.size(), count));
    alphas_.resize(keys_.size());
    pairs_.resize(std::max(pairs_.size(), num_kept + count));
    scene_.quantizer.quantize(origin, scene_.flat, begin, end, keys_.data(), alphas_.data());
    for (std::size_t i = 0; i < count; ++i)
    {
      // Every pair is written, and the next one over it if it does not count: cheaper than a branch nobody can foresee.
      pairs_[num_kept] = {keys_[i], alphas_[i], scene_.flat_bins[begin + i]};
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
void VoteCaster::dropRepeated()
{
  constexpr std::uint32_t GOLDEN = 2654435769u;
  const auto bins = static_cast<std::uint32_t>(scene_.model.table.quantizer().curvature_bins);
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

void VoteCaster::findEntries(BinRange q1)
{
  const FeatureTable& table = scene_.model.table;
  matches_.resize(pairs_.size() * (q1.last - q1.first + 1u));
  matches_.resize(rankPairs(table, pairs_, q1, matches_.data()));
  // Entries lie scattered in memory and are fetched ahead of their use.
  for (TableMatch& match : matches_)
  {
    match.run = table.run(match.run.begin, match.run.end);
    __builtin_prefetch(table.entries() + match.run.begin);
  }
}

std::uint64_t VoteCaster::vote()
{
  const FeatureTable& table = scene_.model.table;
  const VotingParameters& parameters = scene_.parameters;
  const std::uint32_t longest = parameters.max_bucket > 0 ? static_cast<std::uint32_t>(parameters.max_bucket) : ~0u;
  const bool weighted = scene_.model.parameters.feature == FeatureKind::CurPpf;
  const std::uint32_t weight = weighted ? static_cast<std::uint32_t>(parameters.weight) : 1;
  std::uint64_t all = 0;
  for (const TableMatch& match : matches_)
    all += match.run.size() <= longest ? match.run.size() : 0;
  const double share = parameters.max_votes > 0 ? std::min(1.0, parameters.max_votes / static_cast<double>(all)) : 1;
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
