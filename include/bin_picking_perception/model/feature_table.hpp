// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/model/pair_feature.hpp"
#include "bin_picking_perception/model/ranked_bits.hpp"

namespace bin_picking
{
class Executor;

/// Steps and ranges by which Equation 5 becomes six whole numbers.
struct FeatureQuantizer
{
  double distance_step = 0.0025;  ///< d_dist, metres
  double angle_step = 0.2094;     ///< d_angle, rad
  double curvature_step = 30;     ///< d_cur, in the unit of the curvature measure
  double curvature_min = -50;     ///< lower end of the lowest curvature bin; lower values fall into that bin
  int distance_bins = 1;          ///< pairs further apart have no key
  int angle_bins = 15;
  int curvature_bins = 1;  ///< 1: the key has four dimensions

  /// Dense key of the four geometric dimensions; -1 if the distance is out of range.
  std::int64_t geometricKey(const PairFeature& f) const;
  int curvatureBin(float q) const;
  /// Position within the bin, [0, 1).
  double curvatureFraction(float q) const;
  /// One more than the largest geometric key.
  std::uint32_t numGeometricKeys() const
  {
    const auto angles = static_cast<std::uint32_t>(angle_bins);
    return static_cast<std::uint32_t>(distance_bins) * angles * angles * angles;
  }
  /// Dense key of all six dimensions. The product of all bins fits 32 bits (checked by the table).
  std::uint32_t key(std::int64_t geometric_key, int q1_bin, int q2_bin) const
  {
    return static_cast<std::uint32_t>((geometric_key * curvature_bins + q1_bin) * curvature_bins + q2_bin);
  }
};

/// A stored model pair in 32 bits: reference point (15), as an index into FeatureTable::references(), "one point is of
/// low and the other of high curvature" (Equation 8; 1), alpha_m as a fraction of a turn (16).
struct TableEntry
{
  std::uint32_t bits = 0;

  static TableEntry make(std::uint32_t reference, bool weighted, std::uint16_t alpha)
  {
    return {(reference << 17) | (static_cast<std::uint32_t>(weighted) << 16) | alpha};
  }
  std::uint32_t reference() const { return bits >> 17; }
  bool weighted() const { return (bits >> 16) & 1u; }
  std::uint16_t alpha() const { return static_cast<std::uint16_t>(bits); }
};

/// An angle as a 16-bit fraction of a turn, so that differences wrap without a branch.
std::uint16_t toTurnFraction(float angle);

/// Which pairs a table holds.
struct PairSelection
{
  double min_distance = 0;  ///< nearer pairs are not stored, metres
  /// Per point the set of views that see it, as bits, `visibility_words` words each; only pairs that some view sees
  /// together are stored. Empty: every pair.
  std::vector<std::uint64_t> visibility;
  std::size_t visibility_words = 0;
  /// The same for the second points, where they are others than the first. Not used where they are the same.
  std::vector<std::uint64_t> second_visibility;
  /// Points that are the first of a pair, ascending. Empty: every point.
  std::vector<std::uint32_t> references;
};

/// The hash table of Figure 4: quantised feature -> model pairs. The hash is perfect and in two steps: from the four
/// geometric dimensions to a cell, and from cell and curvatures to entries. Entries of one cell and q1 follow each
/// other by q2, so that a range of curvatures is one run. Immutable once built; safe to read from many threads.
class FeatureTable
{
public:
  static constexpr std::uint32_t MAX_REFERENCES = 1u << 15;

  /// Entries [begin, end).
  struct Run
  {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;

    std::uint32_t size() const { return end - begin; }
  };

  FeatureTable() = default;

  /// All selected ordered pairs of distinct points.
  /// \param weighted_class per point: -1 low, +1 high, 0 neither (Equation 8)
  /// \throws ParameterError more than MAX_REFERENCES points, or more bins than 32 bits hold: a coarser leaf or step
  /// helps
  FeatureTable(const OrientedPoints& points, const std::vector<std::int8_t>& weighted_class,
               const PairSelection& selection, const FeatureQuantizer& quantizer, const Executor& executor);

  /// All selected pairs of a point with an edge point (Choi et al. 2012), by the four geometric dimensions: the
  /// direction of the edge takes the place of the second normal. Every entry is weighted(). \param quantizer with one
  /// curvature bin. \throws ParameterError as above
  FeatureTable(const OrientedPoints& points, const OrientedPoints& edges, const PairSelection& selection,
               const FeatureQuantizer& quantizer, const Executor& executor);

  /// False if no stored pair has these four dimensions: the answer for most pairs of a scene, from a bit map that stays
  /// in the nearest cache. \param geometric_key at most FeatureQuantizer::numGeometricKeys(), which has none
  bool hasCell(std::uint32_t geometric_key) const { return cells_.contains(geometric_key); }
  /// \param geometric_key one that has a cell
  std::uint32_t cell(std::uint32_t geometric_key) const { return cells_.rank(geometric_key); }
  /// Stored features before that of a cell and curvatures; keys are FeatureQuantizer::key of the cell.
  std::uint32_t rank(std::uint32_t key_of_cell) const { return features_.rank(key_of_cell); }
  /// Entries of the features from one rank to before another.
  Run run(std::uint32_t first_rank, std::uint32_t end_rank) const { return {starts_[first_rank], starts_[end_rank]}; }
  /// Entries of one feature.
  Run find(std::uint32_t geometric_key, int q1_bin, int q2_bin) const;
  const TableEntry* entries() const { return entries_.data(); }

  /// The points that are the first of a stored pair: TableEntry::reference() is an index into them.
  const std::vector<std::uint32_t>& references() const { return references_; }
  const FeatureQuantizer& quantizer() const { return quantizer_; }
  std::size_t numEntries() const { return entries_.size(); }
  std::size_t numKeys() const { return starts_.size() - 1; }
  std::size_t bytes() const
  {
    return entries_.size() * sizeof(TableEntry) + cells_.bytes() + features_.bytes() +
           (starts_.size() + references_.size()) * sizeof(std::uint32_t);
  }

private:
  friend struct ModelFileAccess;
  using KeyedEntry = std::pair<std::uint32_t, TableEntry>;

  void checkSize(const OrientedPoints& points) const;
  /// \param rows per reference its pairs
  void store(std::vector<std::vector<KeyedEntry>>& rows);
  void makeCells(std::vector<std::vector<KeyedEntry>>& rows);
  void fill(std::vector<std::vector<KeyedEntry>>& rows);

  FeatureQuantizer quantizer_;
  std::vector<std::uint32_t> references_;
  RankedBits cells_ = RankedBits(FeatureQuantizer().numGeometricKeys());  ///< geometric keys that are stored
  RankedBits features_;                                                   ///< keys of cells that are stored
  std::vector<std::uint32_t> starts_ = std::vector<std::uint32_t>(1);     ///< per stored feature; the last is the end
  std::vector<TableEntry> entries_;
};
}  // namespace bin_picking
