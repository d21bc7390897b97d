// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/feature_table.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"

namespace bin_picking
{
std::int64_t FeatureQuantizer::geometricKey(const PairFeature& f) const
{
  const auto distance = static_cast<std::int64_t>(f.distance / distance_step);
  if (distance < 0 || distance >= distance_bins)
    return -1;
  // An angle of pi itself belongs to the last bin.
  const auto bin = [this](float angle) {
    return std::min<std::int64_t>(static_cast<std::int64_t>(angle / angle_step), angle_bins - 1);
  };
  return ((distance * angle_bins + bin(f.angle_n1_d)) * angle_bins + bin(f.angle_n2_d)) * angle_bins +
         bin(f.angle_n1_n2);
}

int FeatureQuantizer::curvatureBin(float q) const
{
  const double position = std::floor((q - curvature_min) / curvature_step);
  return static_cast<int>(std::min(std::max(position, 0.0), static_cast<double>(curvature_bins - 1)));
}

double FeatureQuantizer::curvatureFraction(float q) const
{
  const double position = (q - curvature_min) / curvature_step;
  return std::min(std::max(position - curvatureBin(q), 0.0), 1.0);
}

std::uint16_t toTurnFraction(float angle)
{
  constexpr double TURN = 65536 / (2 * M_PI);
  return static_cast<std::uint16_t>(static_cast<std::int32_t>(std::lround(angle * TURN)) & 0xffff);
}

namespace
{
struct KeyedEntry
{
  std::uint32_t key;
  TableEntry entry;
};

bool covisible(const std::vector<std::uint64_t>& visibility, std::size_t words, std::size_t i, std::size_t j)
{
  if (visibility.empty())
    return true;
  for (std::size_t w = 0; w < words; ++w)
    if (visibility[i * words + w] & visibility[j * words + w])
      return true;
  return false;
}

/// A point without curvature has no key in six dimensions.
bool hasFeature(const OrientedPoints& points, std::size_t i, const FeatureQuantizer& quantizer)
{
  return quantizer.curvature_bins == 1 || !std::isnan(points.curvature[i]);
}

void checkSize(const OrientedPoints& points, const FeatureQuantizer& q)
{
  if (points.size() > FeatureTable::MAX_REFERENCES)
    throw ParameterError("the part has " + std::to_string(points.size()) + " points at this leaf, but at most " +
                         std::to_string(FeatureTable::MAX_REFERENCES) + " can be stored; train with a coarser leaf");
  const double keys = std::pow(q.angle_bins, 3) * q.distance_bins * q.curvature_bins * q.curvature_bins;
  if (keys >= 4294967295.0)
    throw ParameterError("the steps d_dist, d_angle and d_cur make " + std::to_string(keys) +
                         " different features, but at most 4294967295 can be told apart; choose coarser steps");
}

/// All pairs whose first point is `i`, in order of the second.
std::vector<KeyedEntry> pairsOf(std::size_t i, const OrientedPoints& points,
                                const std::vector<std::int8_t>& weighted_class,
                                const std::vector<std::uint64_t>& visibility, std::size_t words,
                                const FeatureQuantizer& quantizer, float min_distance)
{
  std::vector<KeyedEntry> pairs;
  if (!hasFeature(points, i, quantizer))
    return pairs;
  const Eigen::Isometry3f T_local_model = alignToLocalFrame(points.points[i], points.normals[i]);
  const bool with_curvature = quantizer.curvature_bins > 1;
  const float q1 = with_curvature ? points.curvature[i] : 0;
  const int q1_bin = quantizer.curvatureBin(q1);
  for (std::size_t j = 0; j < points.size(); ++j)
  {
    if (j == i || !hasFeature(points, j, quantizer) || !covisible(visibility, words, i, j))
      continue;
    const float q2 = with_curvature ? points.curvature[j] : 0;
    const PairFeature f = pairFeature(points.points[i], points.normals[i], q1, points.points[j], points.normals[j], q2);
    const std::int64_t geometric = f.distance < min_distance ? -1 : quantizer.geometricKey(f);
    if (geometric < 0)
      continue;
    const bool weighted = weighted_class[i] * weighted_class[j] == -1;  // Equation 8: one high, the other low
    pairs.push_back({quantizer.key(geometric, q1_bin, quantizer.curvatureBin(q2)),
                     TableEntry::make(static_cast<std::uint32_t>(i), weighted,
                                      toTurnFraction(alphaInLocalFrame(T_local_model * points.points[j])))});
  }
  return pairs;
}
}  // namespace

FeatureTable::FeatureTable(const OrientedPoints& points, const std::vector<std::int8_t>& weighted_class,
                           const std::vector<std::uint64_t>& visibility, int words, const FeatureQuantizer& quantizer,
                           double min_distance, const Executor& executor)
    : quantizer_(quantizer)
{
  checkSize(points, quantizer);
  std::vector<std::vector<KeyedEntry>> rows(points.size());
  executor.forEach(points.size(), [&](std::size_t i) {
    rows[i] = pairsOf(i, points, weighted_class, visibility, static_cast<std::size_t>(words), quantizer,
                      static_cast<float>(min_distance));
  });

  // Count per key in the hash table, then lay the runs out one behind the other and fill them in order of the
  // reference.
  std::size_t total = 0;
  for (const auto& row : rows)
    total += row.size();
  unsigned bits = 4;
  const auto place = [this](std::uint32_t key) -> Slot& {
    std::size_t position = home(key);
    while (slots_[position].count != 0 && slots_[position].key != key)
      position = (position + 1) & (slots_.size() - 1);
    return slots_[position];
  };
  const auto resize = [&](unsigned new_bits) {
    std::vector<Slot> old = std::move(slots_);
    bits = new_bits;
    shift_ = 32 - bits;
    slots_.assign(std::size_t{1} << bits, Slot{});
    for (const auto& slot : old)
      if (slot.count != 0)
        place(slot.key) = slot;
  };
  resize(bits);
  for (const auto& row : rows)
    for (const auto& pair : row)
    {
      Slot& slot = place(pair.key);
      num_keys_ += slot.count == 0;
      slot.key = pair.key;
      ++slot.count;
      if (2 * num_keys_ > slots_.size())
        resize(bits + 1);
    }
  std::uint32_t begin = 0;
  for (auto& slot : slots_)
  {
    slot.begin = begin;
    begin += slot.count;
  }
  entries_.resize(total);
  std::vector<std::uint32_t> filled(slots_.size(), 0);
  for (auto& row : rows)
  {
    for (const auto& pair : row)
    {
      const Slot& slot = place(pair.key);
      entries_[slot.begin + filled[static_cast<std::size_t>(&slot - slots_.data())]++] = pair.entry;
    }
    std::vector<KeyedEntry>().swap(row);
  }
}

FeatureTable::Slot FeatureTable::find(std::uint32_t key) const
{
  std::size_t position = home(key);
  while (slots_[position].count != 0)
  {
    if (slots_[position].key == key)
      return slots_[position];
    position = (position + 1) & (slots_.size() - 1);
  }
  return {};
}
}  // namespace bin_picking
