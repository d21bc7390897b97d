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

/// A turn that is tried, rad.
struct Angle
{
  double angle = 0;
  bool is_gap = false;  ///< where the surface is worst off beside a turn that stands out: no rival, but not passed over

  bool operator<(const Angle& other) const { return angle < other.angle; }
};

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
  std::vector<Angle> thatStandOut() const
  {
    std::vector<Angle> angles;
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

/// Ascending, from no turn to before a full one, alike in either direction: the even steps, but what stands out in
/// place of those beside it.
std::vector<Angle> anglesToTry(std::vector<Angle> that_stand_out)
{
  constexpr double BESIDE = 5 * M_PI / 180;
  constexpr double SAME = 0.5 * M_PI / 180;
  std::vector<Angle> half = std::move(that_stand_out);
  const auto fixed = static_cast<std::ptrdiff_t>(half.size());
  for (int k = 1; k <= NEAR_SYMMETRY_STEPS / 2; ++k)
  {
    const double angle = 2 * M_PI * k / NEAR_SYMMETRY_STEPS;
    if (std::none_of(half.begin(), half.begin() + fixed,
                     [&](const Angle& other) { return !other.is_gap && std::abs(other.angle - angle) < BESIDE; }))
      half.push_back({angle, false});
  }
  std::sort(half.begin(), half.end());
  half.erase(std::unique(half.begin(), half.end(),
                         [&](const Angle& a, const Angle& b) { return b.angle - a.angle < SAME && b.is_gap; }),
             half.end());
  std::vector<Angle> all = {{0, false}};
  all.insert(all.end(), half.begin(), half.end());
  for (auto angle = half.rbegin(); angle != half.rend(); ++angle)
    if (angle->angle < M_PI - SAME)
      all.push_back({2 * M_PI - angle->angle, angle->is_gap});
  return all;
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
  TurnsAboutAxis(const Symmetry::Axis& axis, const std::vector<Angle>& angles, double slight_deviation)
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
    turns_[k].kind = deviation <= slight_deviation_ ? Kind::Slight : Kind::Near;
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
    Angle tried;
    Kind kind = Kind::Other;
    NearSymmetry near;
  };

  /// What follows a symmetry without a gap moves the surface little because it is a small turn.
  void dropSmallTurns()
  {
    const std::size_t count = turns_.size();
    for (const std::size_t direction : {std::size_t{1}, count - 1})
      for (std::size_t start = 0; start < count; ++start)
        if (turns_[start].kind == Kind::Symmetric)
          for (std::size_t k = (start + direction) % count; turns_[k].kind == Kind::Slight; k = (k + direction) % count)
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
    TurnsAboutAxis turns(axis, anglesToTry(TurnProfile(points, field, axis).thatStandOut()), slight_deviation);
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
