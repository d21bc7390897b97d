// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/near_symmetry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "symmetry_axes.hpp"

namespace bin_picking
{
namespace
{
constexpr double MAX_BROKEN = 0.45;  // share of the surface: beyond it, poses have little in common
constexpr std::size_t MAX_POINTS = 1000;

double brokenShare(const OrientedPoints& surface, const DistanceField& field, const Pose& T, double tolerance)
{
  const Eigen::Isometry3f motion = T.cast<float>();
  const std::size_t step = std::max<std::size_t>(1, surface.size() / MAX_POINTS);
  int broken = 0;
  int tested = 0;
  for (std::size_t i = 0; i < surface.size(); i += step, ++tested)
    broken += std::abs(field.at(motion * surface.points[i])) > static_cast<float>(tolerance);
  return static_cast<double>(broken) / std::max(1, tested);
}

bool isDeclared(const Pose& T, const Symmetry& declared, const OrientedPoints& surface, double tolerance)
{
  const Pose nearest = nearestEquivalent(T, Pose::Identity(), declared);
  double farthest = 0;
  const std::size_t step = std::max<std::size_t>(1, surface.size() / MAX_POINTS);
  for (std::size_t i = 0; i < surface.size(); i += step)
  {
    const Eigen::Vector3d p = surface.points[i].cast<double>();
    farthest = std::max(farthest, (nearest * p - p).norm());
  }
  return farthest < tolerance;
}

/// A hole that is turned away is seen from one side, what stands out from the other.
double deviationOf(const Pose& T, const SelfComparison& surface)
{
  constexpr double ANY = std::numeric_limits<double>::infinity();
  return std::max(surface.mismatch(T, ANY).deviation, surface.mismatch(T.inverse(), ANY).deviation);
}

/// What the steps about one axis do to the part.
class StepsAbout
{
public:
  StepsAbout(const Symmetry::Axis& axis, double slight_deviation) : axis_(axis), slight_deviation_(slight_deviation) {}

  Pose motion(int k) const { return rotationAbout(axis_, 2 * M_PI * k / NEAR_SYMMETRY_STEPS); }
  void setSymmetric(int k) { kind_[static_cast<std::size_t>(k)] = Kind::Symmetric; }

  void setNear(int k, double broken, const SelfComparison& surface)
  {
    const auto step = static_cast<std::size_t>(k);
    const double of_inverse = near_[NEAR_SYMMETRY_STEPS - step].deviation;  // it is the same back and forth
    const double deviation = of_inverse > 0 ? of_inverse : deviationOf(motion(k), surface);
    near_[step] = {motion(k), axis_, broken, deviation};
    kind_[step] = deviation <= slight_deviation_ ? Kind::Slight : Kind::Near;
  }

  std::vector<NearSymmetry> result()
  {
    const bool all_around = std::all_of(kind_.begin(), kind_.end(),
                                        [](Kind kind) { return kind == Kind::Symmetric || kind == Kind::Slight; });
    if (!all_around)
      dropSmallTurns();
    std::vector<NearSymmetry> found;
    for (std::size_t k = 1; k < kind_.size(); ++k)
      if (kind_[k] == Kind::Near || kind_[k] == Kind::Slight)
      {
        near_[k].slight = kind_[k] == Kind::Slight;
        near_[k].slight_all_around = near_[k].slight && all_around;
        found.push_back(near_[k]);
      }
    return found;
  }

private:
  enum class Kind
  {
    Other,
    Near,
    Slight,
    Symmetric
  };

  /// Steps that follow a symmetry without a gap move the surface little because they are small.
  void dropSmallTurns()
  {
    for (const std::size_t direction : {std::size_t{1}, kind_.size() - 1})
      for (std::size_t start = 0; start < kind_.size(); ++start)
        if (kind_[start] == Kind::Symmetric)
          for (std::size_t k = (start + direction) % kind_.size(); kind_[k] == Kind::Slight;
               k = (k + direction) % kind_.size())
            kind_[k] = Kind::Near;
  }

  Symmetry::Axis axis_;
  double slight_deviation_;
  std::array<NearSymmetry, NEAR_SYMMETRY_STEPS> near_;
  std::array<Kind, NEAR_SYMMETRY_STEPS> kind_{Kind::Symmetric};  // the first: not turned at all; the others Other
};
}  // namespace

std::vector<NearSymmetry> findNearSymmetries(const OrientedPoints& surface, const DistanceField& field,
                                             const SelfComparison& exact, const Symmetry& declared, double tolerance,
                                             double slight_deviation)
{
  std::vector<NearSymmetry> found;
  for (const Symmetry::Axis& axis : candidateAxes(Inertia(surface.points)))
  {
    StepsAbout steps(axis, slight_deviation);
    for (int k = 1; k < NEAR_SYMMETRY_STEPS; ++k)
    {
      const Pose T = steps.motion(k);
      const double broken = brokenShare(surface, field, T, tolerance);
      if (broken >= MAX_BROKEN)
        continue;
      if (isDeclared(T, declared, surface, tolerance))
        steps.setSymmetric(k);
      else
        steps.setNear(k, broken, exact);
    }
    const std::vector<NearSymmetry> about_axis = steps.result();
    found.insert(found.end(), about_axis.begin(), about_axis.end());
  }
  return found;
}

bool isSameLine(const Symmetry::Axis& a, const Symmetry::Axis& b, double tolerance)
{
  constexpr double SAME_DIRECTION = 0.999;
  return std::abs(a.direction.dot(b.direction)) > SAME_DIRECTION &&
         (a.origin - b.origin).cross(b.direction).norm() < tolerance;
}
}  // namespace bin_picking
