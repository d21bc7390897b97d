// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "turn_profile.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "bin_picking_perception/model/near_symmetry.hpp"
#include "symmetry_axes.hpp"

namespace bin_picking
{
namespace
{
/// Mean distances of the turned surface from itself, degree by degree.
class TurnProfile
{
public:
  TurnProfile(const std::vector<Eigen::Vector3f>& points, const DistanceField& field, const Symmetry::Axis& axis)
      : points_(points), field_(field), axis_(axis)
  {
    for (int k = 0; k <= 180; ++k)
      distance_[static_cast<std::size_t>(k)] = distanceAt(k * DEGREE);
  }

  /// Up to half a turn: where the surface falls back onto itself, as a gear does tooth by tooth, and the gaps beside.
  std::vector<TriedTurn> thatStandOut() const
  {
    std::vector<TriedTurn> angles;
    for (int k = 1; k <= 180; ++k)
    {
      const int before = worst(k, -1);
      const int after = worst(k, 1);
      if (!isLeast(k) || at(k) > STANDS_OUT * std::min(at(before), at(after)))
        continue;
      angles.push_back({before * DEGREE, true});
      angles.push_back({refined(k), false});
      if (after <= 180)
        angles.push_back({after * DEGREE, true});
    }
    return angles;
  }

private:
  static constexpr double DEGREE = M_PI / 180;
  static constexpr double STANDS_OUT = 0.7;  // of the lower of the two sides
  static constexpr int NEAR_BY = 3;          // degrees: further away another one may stand out
  static constexpr int BESIDE = 8;           // degrees: a gear of 28 teeth is worst off at half of 13

  double distanceAt(double angle) const { return meanDistance(points_, field_, rotationAbout(axis_, angle)); }

  /// Alike in either direction.
  double at(int degrees) const
  {
    const int within = std::abs(degrees) % 360;
    return distance_[static_cast<std::size_t>(std::min(within, 360 - within))];
  }

  int worst(int k, int direction) const
  {
    int worst = k;
    for (int step = 1; step <= BESIDE; ++step)
      if (at(k + direction * step) > at(worst))
        worst = k + direction * step;
    return worst;
  }

  /// Of equals the first.
  bool isLeast(int k) const
  {
    for (int step = 1; step <= NEAR_BY; ++step)
      if (at(k - step) <= at(k) || at(k + step) < at(k))
        return false;
    return true;
  }

  /// To a tenth of a degree.
  double refined(int k) const
  {
    double best = k * DEGREE;
    double least = at(k);
    for (int tenth = -9; tenth <= 9 && k < 180; ++tenth)
      if (const double distance = distanceAt((k + 0.1 * tenth) * DEGREE); distance < least)
      {
        least = distance;
        best = (k + 0.1 * tenth) * DEGREE;
      }
    return best;
  }

  const std::vector<Eigen::Vector3f>& points_;
  const DistanceField& field_;
  const Symmetry::Axis& axis_;
  std::array<double, 181> distance_;
};
}  // namespace

std::vector<TriedTurn> anglesToTry(const std::vector<Eigen::Vector3f>& points, const DistanceField& field,
                                   const Symmetry::Axis& axis)
{
  constexpr double BESIDE = 5 * M_PI / 180;
  constexpr double SAME = 0.5 * M_PI / 180;
  std::vector<TriedTurn> half = TurnProfile(points, field, axis).thatStandOut();
  const auto fixed = static_cast<std::ptrdiff_t>(half.size());
  for (int k = 1; k <= NEAR_SYMMETRY_STEPS / 2; ++k)
  {
    const double angle = 2 * M_PI * k / NEAR_SYMMETRY_STEPS;
    if (std::none_of(half.begin(), half.begin() + fixed,
                     [&](const TriedTurn& other) { return !other.is_gap && std::abs(other.angle - angle) < BESIDE; }))
      half.push_back({angle, false});
  }
  std::sort(half.begin(), half.end());
  half.erase(std::unique(half.begin(), half.end(),
                         [&](const TriedTurn& a, const TriedTurn& b) { return b.angle - a.angle < SAME && b.is_gap; }),
             half.end());
  std::vector<TriedTurn> all = {{0, false}};
  all.insert(all.end(), half.begin(), half.end());
  for (auto angle = half.rbegin(); angle != half.rend(); ++angle)
    if (angle->angle < M_PI - SAME)
      all.push_back({2 * M_PI - angle->angle, angle->is_gap});
  return all;
}
}  // namespace bin_picking
