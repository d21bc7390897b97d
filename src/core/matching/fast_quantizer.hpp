// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bin_picking_perception/model/feature_table.hpp"

namespace bin_picking
{
/// FeatureQuantizer::geometricKey for millions of pairs: the steps of an angle are found on its cosine, without acos.
/// Agrees with it but for angles that lie on a step to within float rounding.
class FastQuantizer
{
public:
  explicit FastQuantizer(const FeatureQuantizer& quantizer);

  /// \param distance |d| > 0; cosines of the three angles of Equation 5. -1 if the distance is out of range
  std::int64_t geometricKey(float distance, float cosine_n1_d, float cosine_n2_d, float cosine_n1_n2) const
  {
    const auto bin = static_cast<std::int64_t>(distance * inverse_step_);
    if (bin >= distance_bins_)
      return -1;
    return ((bin * angle_bins_ + angleBin(cosine_n1_d)) * angle_bins_ + angleBin(cosine_n2_d)) * angle_bins_ +
           angleBin(cosine_n1_n2);
  }

private:
  static constexpr int CELLS = 1024;  ///< of the cosine; each holds at most one or two steps of the angle

  int angleBin(float cosine) const
  {
    const float clamped = cosine < -1 ? -1 : cosine > 1 ? 1 : cosine;
    int bin = first_bin_[static_cast<std::size_t>((clamped + 1) * (CELLS / 2 - 0.5f))];
    while (clamped <= limits_[static_cast<std::size_t>(bin)])
      ++bin;
    return bin;
  }

  float inverse_step_;
  std::int64_t distance_bins_;
  std::int64_t angle_bins_;
  std::vector<float> limits_;  ///< cosine at the upper end of each bin; the last is never reached
  std::array<std::int16_t, CELLS> first_bin_{};
};

/// atan2(y, x) as a 16-bit fraction of a turn, to 0.02 degrees.
std::uint16_t turnFraction(float y, float x);
}  // namespace bin_picking
