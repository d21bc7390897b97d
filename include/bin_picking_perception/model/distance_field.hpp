// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"

namespace bin_picking
{
/// Signed distance to a part's surface on a regular grid: positive outside. Made once, read in a few nanoseconds.
/// Metres, part frame. Immutable; safe to read from many threads.
class DistanceField
{
public:
  DistanceField() = default;

  /// \param surface dense: nearest neighbours about half a cell apart
  /// \param cell edge of the grid's cells, metres; the distance is exact to about a quarter of it
  /// \param band greater distances are cut to it, metres; several cells
  DistanceField(const OrientedPoints& surface, double cell, double band);

  bool empty() const { return values_.empty(); }
  float band() const { return band_; }

  /// In [-band, band]; band outside of the grid.
  float at(const Eigen::Vector3f& p) const
  {
    const Eigen::Array3f q = (p - low_).array() * inverse_cell_;
    if ((q < 0).any() || (q >= limit_).any())
      return band_;
    const Eigen::Array3i i = q.cast<int>();
    const Eigen::Array3f f = q - i.cast<float>();
    const std::size_t k = (static_cast<std::size_t>(i.z()) * rows_ + static_cast<std::size_t>(i.y())) * columns_ +
                          static_cast<std::size_t>(i.x());
    const std::size_t up = rows_ * columns_;
    const float bottom = mix(alongX(k, f.x()), alongX(k + columns_, f.x()), f.y());
    const float top = mix(alongX(k + up, f.x()), alongX(k + up + columns_, f.x()), f.y());
    return step_ * mix(bottom, top, f.z());
  }

  struct Sample
  {
    float distance = 0;
    Eigen::Vector3f gradient = Eigen::Vector3f::Zero();  ///< of the distance, that is, about the surface's normal
  };

  /// The distance as at() gives it, and how it changes from place to place; outside of the grid it does not.
  Sample sample(const Eigen::Vector3f& p) const
  {
    const Eigen::Array3f q = (p - low_).array() * inverse_cell_;
    if ((q < 0).any() || (q >= limit_).any())
      return {band_, Eigen::Vector3f::Zero()};
    const Eigen::Array3i i = q.cast<int>();
    const Eigen::Array3f f = q - i.cast<float>();
    const std::size_t k = (static_cast<std::size_t>(i.z()) * rows_ + static_cast<std::size_t>(i.y())) * columns_ +
                          static_cast<std::size_t>(i.x());
    const std::size_t up = rows_ * columns_;
    // Along x on the four edges of the cell, then between the edges.
    const Edge e00 = edge(k, f.x());
    const Edge e10 = edge(k + columns_, f.x());
    const Edge e01 = edge(k + up, f.x());
    const Edge e11 = edge(k + up + columns_, f.x());
    const float bottom = mix(e00.value, e10.value, f.y());
    const float top = mix(e01.value, e11.value, f.y());
    const Eigen::Vector3f slope(mix(mix(e00.slope, e10.slope, f.y()), mix(e01.slope, e11.slope, f.y()), f.z()),
                                mix(e10.value - e00.value, e11.value - e01.value, f.z()), top - bottom);
    return {step_ * mix(bottom, top, f.z()), step_ * inverse_cell_ * slope};
  }

  /// Places that are looked up at once, in about half the time of one by one.
  static constexpr std::size_t BLOCK = 64;
  using Numbers = std::array<float, BLOCK>;
  struct Places
  {
    Numbers x = {};
    Numbers y = {};
    Numbers z = {};
  };
  struct Samples
  {
    Numbers distance = {};
    Numbers gradient_x = {};
    Numbers gradient_y = {};
    Numbers gradient_z = {};
  };

  /// at() and sample() of all places of a block; NaN lies outside of the grid.
  void at(const Places& places, Numbers& distances) const;
  void sample(const Places& places, Samples& samples) const;

private:
  friend struct ModelFileAccess;
  template <typename Finish>
  void inCells(const Places& places, const Finish& finish) const;
  struct Edge
  {
    float value;
    float slope;
  };
  Edge edge(std::size_t k, float share) const
  {
    const auto begin = static_cast<float>(values_[k]);
    const float slope = static_cast<float>(values_[k + 1]) - begin;
    return {begin + share * slope, slope};
  }

  /// What follows from the sizes: the step of the values and the last cell.
  void fillDerived();
  float alongX(std::size_t k, float share) const
  {
    return mix(static_cast<float>(values_[k]), static_cast<float>(values_[k + 1]), share);
  }
  static float mix(float a, float b, float share) { return a + share * (b - a); }

  float band_ = 0;
  float inverse_cell_ = 0;
  Eigen::Vector3f low_ = Eigen::Vector3f::Zero();
  Eigen::Array3f limit_ = Eigen::Array3f::Zero();
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  float step_ = 0;                    ///< metres per unit of the values
  std::vector<std::int16_t> values_;  ///< x fastest; 16 bits resolve a 32767th of the band
};
}  // namespace bin_picking
