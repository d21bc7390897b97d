// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/feature_table.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
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
using KeyedEntry = std::pair<std::uint32_t, TableEntry>;

bool covisible(const PairSelection& selection, std::size_t i, std::size_t j)
{
  const std::size_t words = selection.visibility_words;
  if (selection.visibility.empty())
    return true;
  for (std::size_t w = 0; w < words; ++w)
    if (selection.visibility[i * words + w] & selection.visibility[j * words + w])
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

/// All pairs whose first point is `i`, in order of the second. \param row index of `i` among the references
std::vector<KeyedEntry> pairsOf(std::size_t i, std::uint32_t row, const OrientedPoints& points,
                                const std::vector<std::int8_t>& weighted_class, const PairSelection& selection,
                                const FeatureQuantizer& quantizer)
{
  std::vector<KeyedEntry> pairs;
  if (!hasFeature(points, i, quantizer))
    return pairs;
  const auto min_distance = static_cast<float>(selection.min_distance);
  const Eigen::Isometry3f T_local_model = alignToLocalFrame(points.points[i], points.normals[i]);
  const bool with_curvature = quantizer.curvature_bins > 1;
  const float q1 = with_curvature ? points.curvature[i] : 0;
  const int q1_bin = quantizer.curvatureBin(q1);
  for (std::size_t j = 0; j < points.size(); ++j)
  {
    if (j == i || !hasFeature(points, j, quantizer) || !covisible(selection, i, j))
      continue;
    const float q2 = with_curvature ? points.curvature[j] : 0;
    const PairFeature f = pairFeature(points.points[i], points.normals[i], q1, points.points[j], points.normals[j], q2);
    const std::int64_t geometric = f.distance < min_distance ? -1 : quantizer.geometricKey(f);
    if (geometric < 0)
      continue;
    const bool weighted = weighted_class[i] * weighted_class[j] == -1;  // Equation 8: one high, the other low
    const std::uint16_t alpha = toTurnFraction(alphaInLocalFrame(T_local_model * points.points[j]));
    pairs.emplace_back(quantizer.key(geometric, q1_bin, quantizer.curvatureBin(q2)),
                       TableEntry::make(row, weighted, alpha));
  }
  return pairs;
}
}  // namespace

FeatureTable::FeatureTable(const OrientedPoints& points, const std::vector<std::int8_t>& weighted_class,
                           const PairSelection& selection, const FeatureQuantizer& quantizer, const Executor& executor)
    : quantizer_(quantizer), references_(selection.references)
{
  checkSize(points, quantizer);
  if (references_.empty())
  {
    references_.resize(points.size());
    std::iota(references_.begin(), references_.end(), 0u);
  }
  std::vector<std::vector<KeyedEntry>> rows(references_.size());
  executor.forEach(rows.size(), [&](std::size_t r) {
    rows[r] = pairsOf(references_[r], static_cast<std::uint32_t>(r), points, weighted_class, selection, quantizer);
  });
  makeCells(rows);
  fill(rows);
}

/// Replaces the geometric part of the keys by the cell.
void FeatureTable::makeCells(std::vector<std::vector<KeyedEntry>>& rows)
{
  const auto curvatures = static_cast<std::uint32_t>(quantizer_.curvature_bins * quantizer_.curvature_bins);
  cells_ = RankedBits(quantizer_.numGeometricKeys());
  for (const auto& row : rows)
    for (const KeyedEntry& pair : row)
      cells_.insert(pair.first / curvatures);
  features_ = RankedBits(static_cast<std::size_t>(cells_.rankMembers()) * curvatures);
  for (auto& row : rows)
    for (KeyedEntry& pair : row)
    {
      pair.first = cells_.rank(pair.first / curvatures) * curvatures + pair.first % curvatures;
      features_.insert(pair.first);
    }
}

/// Counting sort: count the entries of each feature, and put them in order of the reference.
void FeatureTable::fill(std::vector<std::vector<KeyedEntry>>& rows)
{
  starts_.assign(features_.rankMembers() + 1, 0);
  for (const auto& row : rows)
    for (const KeyedEntry& pair : row)
      ++starts_[rank(pair.first)];
  std::uint32_t end = 0;
  for (std::uint32_t& start : starts_)
    start = (end += start);
  entries_.resize(end);
  for (auto row = rows.rbegin(); row != rows.rend(); ++row)
  {
    for (auto pair = row->rbegin(); pair != row->rend(); ++pair)
      entries_[--starts_[rank(pair->first)]] = pair->second;
    std::vector<KeyedEntry>().swap(*row);
  }
}

FeatureTable::Run FeatureTable::find(std::uint32_t geometric_key, int q1_bin, int q2_bin) const
{
  if (!hasCell(geometric_key))
    return {};
  const std::uint32_t key = quantizer_.key(cell(geometric_key), q1_bin, q2_bin);
  return run(rank(key), rank(key + 1));
}
}  // namespace bin_picking
