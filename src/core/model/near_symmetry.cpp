// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/near_symmetry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "symmetry_axes.hpp"
#include "turn_profile.hpp"

namespace bin_picking
{
namespace
{
constexpr double MAX_BROKEN = 0.45;  // share of the surface: beyond it, poses have little in common
constexpr std::size_t MAX_POINTS = 1000;

bool isDeclared(const Pose& T, const Symmetry& declared, const std::vector<Eigen::Vector3f>& points, double tolerance)
{
  const Pose nearest = nearestEquivalent(T, Pose::Identity(), declared);
  return std::all_of(points.begin(), points.end(), [&](const Eigen::Vector3f& point) {
    const Eigen::Vector3d p = point.cast<double>();
    return (nearest * p - p).norm() < tolerance;
  });
}

std::vector<Eigen::Vector3f> fewOf(const std::vector<Eigen::Vector3f>& points)
{
  std::vector<Eigen::Vector3f> few;
  for (std::size_t i = 0; i < points.size(); i += std::max<std::size_t>(1, points.size() / MAX_POINTS))
    few.push_back(points[i]);
  return few;
}

/// A hole that is turned away is seen from one side, what stands out from the other.
double deviationOf(const Pose& T, const SelfComparison& surface)
{
  constexpr double ANY = std::numeric_limits<double>::infinity();
  return std::max(surface.mismatch(T, ANY).deviation, surface.mismatch(T.inverse(), ANY).deviation);
}

/// What the turns about one axis do to the part.
class TurnsAboutAxis
{
public:
  /// \param angles ascending; the first is no turn at all
  TurnsAboutAxis(const Symmetry::Axis& axis, const std::vector<TriedTurn>& angles, double slight_deviation)
      : axis_(axis), slight_deviation_(slight_deviation), turns_(angles.size())
  {
    for (std::size_t k = 0; k < angles.size(); ++k)
      turns_[k].tried = angles[k];
    turns_.front().kind = Kind::Symmetric;
  }

  std::size_t size() const { return turns_.size(); }
  Pose motion(std::size_t k) const { return rotationAbout(axis_, turns_[k].tried.angle); }
  void setSymmetric(std::size_t k) { turns_[k].kind = Kind::Symmetric; }

  void setNear(std::size_t k, double broken, const SelfComparison& surface)
  {
    const double of_inverse = turns_[turns_.size() - k].near.deviation;  // it is the same back and forth
    const double deviation = of_inverse > 0 ? of_inverse : deviationOf(motion(k), surface);
    turns_[k].near = {motion(k), axis_, broken, deviation};
    turns_[k].kind = isSlight(turns_[k].near) ? Kind::Slight : Kind::Near;
  }

  std::vector<NearSymmetry> result()
  {
    const bool all_around = std::all_of(turns_.begin(), turns_.end(), [](const Turn& turn) {
      return turn.kind == Kind::Symmetric || turn.kind == Kind::Slight;
    });
    if (!all_around)
      dropSmallTurns();
    std::vector<NearSymmetry> found;
    for (Turn& turn : turns_)
      if (!turn.tried.is_gap && (turn.kind == Kind::Near || turn.kind == Kind::Slight))
      {
        turn.near.slight = turn.kind == Kind::Slight;
        turn.near.slight_all_around = turn.near.slight && all_around;
        found.push_back(turn.near);
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

  struct Turn
  {
    TriedTurn tried;
    Kind kind = Kind::Other;
    NearSymmetry near;
  };

  bool isSlight(const NearSymmetry& near) const
  {
    return near.deviation <= (near.broken <= SMALL_FEATURE ? 2 : 1) * slight_deviation_;
  }

  /// Half a tooth moves much of the surface, if by little.
  static bool isGap(const Turn& turn) { return turn.tried.is_gap && turn.near.broken > SMALL_FEATURE; }

  /// What follows a symmetry without a gap moves the surface little because it is a small turn.
  void dropSmallTurns()
  {
    const std::size_t count = turns_.size();
    for (const std::size_t direction : {std::size_t{1}, count - 1})
      for (std::size_t start = 0; start < count; ++start)
        if (turns_[start].kind == Kind::Symmetric)
          for (std::size_t k = (start + direction) % count; turns_[k].kind == Kind::Slight && !isGap(turns_[k]);
               k = (k + direction) % count)
            turns_[k].kind = Kind::Near;
  }

  Symmetry::Axis axis_;
  double slight_deviation_;
  std::vector<Turn> turns_;
};

/// Each line once, where the turns about it that keep most of the surface have it.
std::vector<Symmetry::Axis> settledAxes(const OrientedPoints& surface, const std::vector<Eigen::Vector3f>& points,
                                        const DistanceField& field, double tolerance)
{
  std::vector<Symmetry::Axis> axes;
  for (const Symmetry::Axis& candidate : candidateAxes(Inertia(surface.points)))
  {
    const Symmetry::Axis axis = settledAxis(points, field, candidate, tolerance);
    if (std::none_of(axes.begin(), axes.end(),
                     [&](const Symmetry::Axis& other) { return isSameLine(axis, other, tolerance / 2); }))
      axes.push_back(axis);
  }
  return axes;
}
}  // namespace

std::vector<NearSymmetry> findNearSymmetries(const OrientedPoints& surface, const DistanceField& field,
                                             const SelfComparison& exact, const Symmetry& declared, double tolerance,
                                             double slight_deviation)
{
  const std::vector<Eigen::Vector3f> points = fewOf(surface.points);
  std::vector<NearSymmetry> found;
  for (const Symmetry::Axis& axis : settledAxes(surface, points, field, tolerance))
  {
    TurnsAboutAxis turns(axis, anglesToTry(points, field, axis), slight_deviation);
    for (std::size_t k = 1; k < turns.size(); ++k)
    {
      const Pose T = turns.motion(k);
      const double broken = brokenShare(points, field, T, tolerance);
      if (broken >= MAX_BROKEN)
        continue;
      if (isDeclared(T, declared, points, tolerance))
        turns.setSymmetric(k);
      else
        turns.setNear(k, broken, exact);
    }
    const std::vector<NearSymmetry> about_axis = turns.result();
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
