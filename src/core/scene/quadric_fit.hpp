// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <array>

#include "neighbourhood.hpp"

namespace bin_picking
{
/// Sums over points (x, y, z) of all that the least squares fit of z = a x^2 + b x y + c y^2 + d x + e y + f needs.
class QuadricMoments
{
public:
  static constexpr std::size_t NUM_POWERS = 15;  // x^i y^j up to the fourth order
  static constexpr std::size_t NUM_RIGHT = 6;    // z times those up to the second

  QuadricMoments() : sums_{} {}
  /// \param sums in the order of the enumerators
  explicit QuadricMoments(const std::array<double, NUM_POWERS + NUM_RIGHT>& sums) : sums_(sums) {}

  QuadricMoments& operator+=(const QuadricMoments& other)
  {
    for (std::size_t k = 0; k < sums_.size(); ++k)
      sums_[k] += other.sums_[k];
    return *this;
  }

  double count() const { return sums_[0]; }
  /// Mean curvature at the origin (Equations 1 to 4); NaN if the points do not fix the quadric.
  double meanCurvature() const;

private:
  std::array<double, NUM_POWERS + NUM_RIGHT> sums_;
};

/// Rows: two axes of the tangent plane and the normal, in units of the radius, so that fits are well scaled.
Eigen::Matrix3f tangentFrame(const Eigen::Vector3f& normal, double radius);

/// Moments of the neighbours whose normal is turned by no more than min_cosine says.
/// \param frame maps offsets from the sample into the frame of the fit
QuadricMoments quadricMoments(const Neighbourhood& found, const Eigen::Matrix3f& frame, const Eigen::Vector3f& normal,
                              float min_cosine);
}  // namespace bin_picking
