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

  /// \param sums in the order of the enumerators
  explicit QuadricMoments(const std::array<double, NUM_POWERS + NUM_RIGHT>& sums) : sums_(sums) {}

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

/// Whose neighbours count, and the frame of their fit.
struct QuadricQuery
{
  Eigen::Vector3f point;
  Eigen::Vector3f normal;
  Eigen::Matrix<float, 3, 3, Eigen::RowMajor> frame;  ///< maps offsets from the point
  float radius;
  float min_cosine;
};

/// Adds up the moments of points that come run by run.
class QuadricSums
{
public:
  /// Of points begin to end those that count. The planes can be read to a multiple of LANES behind begin.
  void add(const PointPlanes& planes, std::size_t begin, std::size_t end, const QuadricQuery& query);

  QuadricMoments moments() const;

private:
  using Lanes = std::array<float, Neighbourhood::LANES>;
  std::array<Lanes, QuadricMoments::NUM_POWERS + QuadricMoments::NUM_RIGHT> sums_ = {};
};
}  // namespace bin_picking
