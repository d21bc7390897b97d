// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "bin_picking_perception/model/feature_table.hpp"

namespace bin_picking
{
/// Points and normals as flat arrays, one per coordinate.
struct FlatPoints
{
  std::vector<float> x, y, z, nx, ny, nz;

  FlatPoints(const OrientedPoints& points, const std::vector<int>& order);
};

/// The first point of many pairs, with the y and z axes of its local frame (Equation 6).
struct PairOrigin
{
  Eigen::Vector3f point, normal, to_y, to_z;

  PairOrigin(const Eigen::Vector3f& p, const Eigen::Vector3f& n);
};

/// FeatureQuantizer::geometricKey and alpha_s of Equation 7 for millions of pairs, many at a time. Agrees with the
/// exact functions but for values that lie on a step to within float rounding; alpha_s is exact to 0.01 degrees.
class PairQuantizer
{
public:
  /// Pairs nearer than min_distance or farther apart than `reach` get the key that no pair has, numGeometricKeys().
  PairQuantizer(const FeatureQuantizer& quantizer, double min_distance, double reach);

  /// Pairs of `origin` with points [begin, end). \param keys, alphas room for as many; alpha as a fraction of a turn
  void quantize(const PairOrigin& origin, const FlatPoints& points, std::size_t begin, std::size_t end,
                std::uint32_t* keys, std::uint16_t* alphas) const;

private:
  float squared_min_;
  float squared_max_;
  float inverse_distance_step_;
  float inverse_angle_step_;
  std::int32_t distance_bins_;
  std::int32_t angle_bins_;
  std::uint32_t no_key_;
};
}  // namespace bin_picking
