// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "../common/tile_index.hpp"
#include "accumulator.hpp"
#include "bin_picking_perception/matching/voting.hpp"
#include "pair_quantizer.hpp"

namespace bin_picking
{
/// Curvature bins that a scene point is looked up in.
struct BinRange
{
  std::uint8_t first = 0;
  std::uint8_t last = 0;
};

/// A scene pair whose geometry a table holds.
struct ScenePair
{
  std::uint32_t geometric_key;
  std::uint16_t alpha_s;
  BinRange q2;
};

/// Table entries that a scene pair meets.
struct TableMatch
{
  FeatureTable::Run run;
  std::uint16_t alpha_s;
};

/// Scene points that are the second of pairs, and the table in which these are looked up.
struct SecondPoints
{
  const FeatureTable& table;
  TileIndex tiles;
  FlatPoints flat;                  ///< in the order of the tiles
  std::vector<BinRange> flat_bins;  ///< in the order of the tiles
  PairQuantizer quantizer;

  /// \param reach of a pair, metres. \param curvature_bins per point; empty: the table has one bin
  SecondPoints(const FeatureTable& table, const OrientedPoints& points, const std::vector<BinRange>& curvature_bins,
               double min_distance, float reach);
};

/// The scene as all reference points see it.
struct VotingScene
{
  const TrainedModel& model;
  const OrientedPoints& points;
  const VotingParameters& parameters;
  float reach;                           ///< of a pair, metres
  std::vector<BinRange> curvature_bins;  ///< per point
  SecondPoints surface;                  ///< `points`
  SecondPoints edges;

  VotingScene(const TrainedModel& trained_model, const OrientedPoints& samples,
              const std::vector<std::uint8_t>& curvature_complete, const OrientedPoints& edge_points,
              const VotingParameters& voting);
};

/// Fills the accumulator for one reference point after the other. Holds the memory that this takes: one per thread.
class VoteCaster
{
public:
  explicit VoteCaster(const VotingScene& scene);

  /// Section 2.2.3 for one reference point: Equation 5 with every sample and edge point within reach, look-up, and
  /// votes into the cleared accumulator.
  void cast(std::size_t reference, VotingStatistics& statistics);

  Accumulator& accumulator() { return accumulator_; }

private:
  void castPairs(std::size_t reference, const SecondPoints& seconds, BinRange q1, int max_votes, int weight,
                 VotingStatistics& statistics);
  std::uint64_t collectPairs(std::size_t reference, const SecondPoints& seconds);
  void dropRepeated(const FeatureTable& table);
  void findEntries(const FeatureTable& table, BinRange q1);
  std::uint64_t vote(const FeatureTable& table, int max_votes, std::uint32_t weight);

  const VotingScene& scene_;
  std::uint32_t num_angles_;
  Accumulator accumulator_;
  std::vector<std::uint32_t> keys_;
  std::vector<std::uint16_t> alphas_;
  std::vector<ScenePair> pairs_;
  std::vector<std::uint32_t> seen_;  ///< hash set of pairs; 0: empty
  std::vector<TableMatch> matches_;
};
}  // namespace bin_picking
