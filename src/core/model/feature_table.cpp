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

bool share(const std::vector<std::uint64_t>& a, std::size_t i, const std::vector<std::uint64_t>& b, std::size_t j,
           std::size_t words)
{
  if (a.empty())
    return true;
  for (std::size_t w = 0; w < words; ++w)
    if (a[i * words + w] & b[j * words + w])
      return true;
  return false;
}

/// A point without curvature has no key in six dimensions.
bool hasFeature(const OrientedPoints& points, std::size_t i, const FeatureQuantizer& quantizer)
{
  return quantizer.curvature_bins == 1 || !std::isnan(points.curvature[i]);
}

/// 0 where the key has no curvature.
float curvatureOf(const OrientedPoints& points, std::size_t i, const FeatureQuantizer& quantizer)
{
  return quantizer.curvature_bins > 1 ? points.curvature[i] : 0;
}

/// Pairs with one first point.
class PairsOf
{
public:
  /// \param row index of `i` among the references
  PairsOf(const OrientedPoints& points, std::size_t i, std::uint32_t row, double min_distance,
          const FeatureQuantizer& quantizer)
      : p1_(points.points[i]),
        n1_(points.normals[i]),
        q1_(curvatureOf(points, i, quantizer)),
        T_local_model_(alignToLocalFrame(p1_, n1_)),
        row_(row),
        min_distance_(static_cast<float>(min_distance)),
        quantizer_(quantizer)
  {}

  void add(const OrientedPoints& seconds, std::size_t j, bool weighted, std::vector<KeyedEntry>& pairs) const
  {
    const float q2 = curvatureOf(seconds, j, quantizer_);
    const PairFeature f = pairFeature(p1_, n1_, q1_, seconds.points[j], seconds.normals[j], q2);
    const std::int64_t geometric = f.distance < min_distance_ ? -1 : quantizer_.geometricKey(f);
    if (geometric < 0)
      return;
    const std::uint16_t alpha = toTurnFraction(alphaInLocalFrame(T_local_model_ * seconds.points[j]));
    pairs.emplace_back(quantizer_.key(geometric, quantizer_.curvatureBin(q1_), quantizer_.curvatureBin(q2)),
                       TableEntry::make(row_, weighted, alpha));
  }

private:
  const Eigen::Vector3f& p1_;
  const Eigen::Vector3f& n1_;
  float q1_;
  Eigen::Isometry3f T_local_model_;
  std::uint32_t row_;
  float min_distance_;
  const FeatureQuantizer& quantizer_;
};

std::vector<std::uint32_t> selectedReferences(const OrientedPoints& points, const PairSelection& selection)
{
  std::vector<std::uint32_t> references = selection.references;
  if (references.empty())
  {
    references.resize(points.size());
    std::iota(references.begin(), references.end(), 0u);
  }
  return references;
}
}  // namespace

FeatureTable::FeatureTable(const OrientedPoints& points, const std::vector<std::int8_t>& weighted_class,
                           const PairSelection& selection, const FeatureQuantizer& quantizer, const Executor& executor)
    : quantizer_(quantizer), references_(selectedReferences(points, selection))
{
  checkSize(points);
  std::vector<std::vector<KeyedEntry>> rows(references_.size());
  executor.forEach(rows.size(), [&](std::size_t r) {
    const std::size_t i = references_[r];
    if (!hasFeature(points, i, quantizer))
      return;
    const PairsOf pairs(points, i, static_cast<std::uint32_t>(r), selection.min_distance, quantizer);
    for (std::size_t j = 0; j < points.size(); ++j)
      if (j != i && hasFeature(points, j, quantizer) &&
          share(selection.visibility, i, selection.visibility, j, selection.visibility_words))
        pairs.add(points, j, weighted_class[i] * weighted_class[j] == -1, rows[r]);  // Equation 8: one high, one low
  });
  store(rows);
}

FeatureTable::FeatureTable(const OrientedPoints& points, const OrientedPoints& edges, const PairSelection& selection,
                           const FeatureQuantizer& quantizer, const Executor& executor)
    : quantizer_(quantizer), references_(selectedReferences(points, selection))
{
  checkSize(points);
  std::vector<std::vector<KeyedEntry>> rows(references_.size());
  executor.forEach(rows.size(), [&](std::size_t r) {
    const std::size_t i = references_[r];
    const PairsOf pairs(points, i, static_cast<std::uint32_t>(r), selection.min_distance, quantizer);
    for (std::size_t j = 0; j < edges.size(); ++j)
      if (share(selection.visibility, i, selection.second_visibility, j, selection.visibility_words))
        pairs.add(edges, j, true, rows[r]);
  });
  store(rows);
}

void FeatureTable::checkSize(const OrientedPoints& points) const
{
  if (points.size() > MAX_REFERENCES)
    throw ParameterError("the part has " + std::to_string(points.size()) + " points at this leaf, but at most " +
                         std::to_string(MAX_REFERENCES) + " can be stored; train with a coarser leaf");
  const FeatureQuantizer& q = quantizer_;
  const double keys = std::pow(q.angle_bins, 3) * q.distance_bins * q.curvature_bins * q.curvature_bins;
  if (keys >= 4294967295.0)
    throw ParameterError("the steps d_dist, d_angle and d_cur make " + std::to_string(keys) +
                         " different features, but at most 4294967295 can be told apart; choose coarser steps");
}

void FeatureTable::store(std::vector<std::vector<KeyedEntry>>& rows)
{
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
