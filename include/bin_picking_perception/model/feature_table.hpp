// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/model/pair_feature.hpp"

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
  /// Dense key of all six dimensions. Throws nothing; the product of all bins fits 32 bits (checked by the table).
  std::uint32_t key(std::int64_t geometric_key, int q1_bin, int q2_bin) const
  {
    return static_cast<std::uint32_t>((geometric_key * curvature_bins + q1_bin) * curvature_bins + q2_bin);
  }
};

/// A stored model pair in 32 bits: reference point (15), "one point is of low and the other of high curvature"
/// (Equation 8; 1), alpha_m as a fraction of a turn (16).
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

/// The hash table of Figure 4: quantised feature -> model pairs. Flat arrays: open addressing for the keys, one array
/// of entries behind. Immutable once built; safe to read from many threads.
class FeatureTable
{
public:
  static constexpr std::uint32_t MAX_REFERENCES = 1u << 15;

  struct Slot
  {
    std::uint32_t key = 0;
    std::uint32_t begin = 0;
    std::uint32_t count = 0;  ///< 0: empty slot
  };

  FeatureTable() = default;

  /// All ordered pairs of distinct points (further apart than min_distance) that `pairs_allowed` admits.
  /// \param weighted_class per point: -1 low, +1 high, 0 neither (Equation 8)
  /// \param visibility per point the set of views that see it, as bits, `words` words each; empty: every pair counts
  /// \throws ParameterError more than MAX_REFERENCES points, or more bins than 32 bits hold: a coarser leaf or step
  /// helps
  FeatureTable(const OrientedPoints& points, const std::vector<std::int8_t>& weighted_class,
               const std::vector<std::uint64_t>& visibility, int words, const FeatureQuantizer& quantizer,
               double min_distance, const Executor& executor);

  /// Entries stored under a key; count 0 if none.
  Slot find(std::uint32_t key) const;
  /// Hints the processor to fetch the slot of a key that is looked up soon.
  void prefetch(std::uint32_t key) const { __builtin_prefetch(&slots_[home(key)]); }
  const TableEntry* entries() const { return entries_.data(); }

  const FeatureQuantizer& quantizer() const { return quantizer_; }
  std::size_t numEntries() const { return entries_.size(); }
  std::size_t numKeys() const { return num_keys_; }
  std::size_t bytes() const { return entries_.size() * sizeof(TableEntry) + slots_.size() * sizeof(Slot); }

private:
  friend struct ModelFileAccess;
  /// Fibonacci hashing; at least one slot stays empty, so that every search ends.
  std::size_t home(std::uint32_t key) const { return (key * 2654435769u) >> shift_; }

  FeatureQuantizer quantizer_;
  std::vector<Slot> slots_ = std::vector<Slot>(2);  ///< a power of two, at most half full
  std::vector<TableEntry> entries_;
  std::size_t num_keys_ = 0;
  unsigned shift_ = 31;  ///< 32 - log2(number of slots)
};
}  // namespace bin_picking
