// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/symmetry_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bin_picking_perception/common/error.hpp"
#include "symmetry_axes.hpp"
#include "symmetry_group.hpp"

namespace bin_picking
{
namespace
{
constexpr int MAX_ORDER = 60;      // the teeth of a gear; with a flip, as many rotations as a symmetry may have
constexpr int MAX_FEW_SIDES = 12;  // of a polygon: higher orders must stand out against the turns between them
constexpr double ALL = std::numeric_limits<double>::infinity();
constexpr int REVOLUTION_STEPS = 37;  // prime: no polygon of few sides repeats at all of them
constexpr std::size_t COARSE_POINTS = 400;
constexpr double MAX_COARSE = 0.3;  // of the band: a mean distance beyond it is no rotation that a refinement mends
constexpr std::size_t MAX_REFINED = 48;
constexpr double MAX_ALMOST_SHARE = 0.25;
constexpr std::size_t MAX_ALMOST = 3;
constexpr double SAME_DIRECTION = 0.99;
/// Of measured axes: turns that are nearer than this are one.
constexpr SymmetryTolerance MEASURED = {0.035, 1e-3};

double angleOf(int order) { return 2 * M_PI / order; }

class Search
{
public:
  Search(const SelfComparison& surface, const DistanceField& field, double tolerance)
      : surface_(surface), field_(field), inertia_(surface.queries().points)
  {
    report_.tolerance = tolerance;
    const auto& points = surface.queries().points;
    coarse_.assign(points.begin(),
                   points.begin() + static_cast<std::ptrdiff_t>(std::min(COARSE_POINTS, points.size())));
  }

  SymmetryReport run()
  {
    const std::vector<Symmetry::Axis> candidates = candidateAxes(inertia_);
    for (const Symmetry::Axis& axis : candidates)
      findRevolution(axis);
    if (report_.symmetry.continuous)
      findFlip();
    else
    {
      for (const Symmetry::Axis& axis : candidates)
        findHighestOrder(axis);
      findUndecided();
    }
    if (!report_.round)
      for (const Symmetry::Axis& axis : candidates)
        findAlmost(axis);
    keepBestAlmost();
    return report_;
  }

private:
  double tolerance() const { return report_.tolerance; }

  /// The axis, or its refinement, about which a turn keeps the surface; nothing if it does not.
  std::optional<Symmetry::Axis> keptBy(const Symmetry::Axis& axis, double angle) const
  {
    if (meanDistance(coarse_, field_, rotationAbout(axis, angle)) > MAX_COARSE * static_cast<double>(field_.band()))
      return std::nullopt;
    const Symmetry::Axis refined = refinedAxis(coarse_, field_, {axis.direction, inertia_.center}, angle, ALL);
    const double gain = meanDistance(coarse_, field_, rotationAbout(axis, angle)) -
                        meanDistance(coarse_, field_, rotationAbout(refined, angle));
    // Round numbers of a drawing are better than equally good measured ones.
    const Symmetry::Axis& first = gain < 0.05 * tolerance() ? axis : refined;
    for (const Symmetry::Axis& one : {first, refined})
      if (surface_.keeps(rotationAbout(one, angle), tolerance()))
        return one;
    return std::nullopt;
  }

  void findRevolution(const Symmetry::Axis& candidate)
  {
    if (report_.round)
      return;
    constexpr int QUARTER = REVOLUTION_STEPS / 4;
    const std::optional<Symmetry::Axis> axis = keptBy(candidate, angleOf(REVOLUTION_STEPS) * QUARTER);
    if (!axis)
      return;
    for (int k = 1; k <= REVOLUTION_STEPS / 2; ++k)
      if (!surface_.keeps(rotationAbout(*axis, angleOf(REVOLUTION_STEPS) * k), tolerance()))
        return;
    if (!report_.symmetry.continuous)
      report_.symmetry.continuous = axis;
    else
      report_.round = std::abs(report_.symmetry.continuous->direction.dot(axis->direction)) < 0.9;
    report_.found.push_back(
        {*axis, AxisFinding::CONTINUOUS, surface_.mismatch(worstTurn(*axis, AxisFinding::CONTINUOUS), tolerance())});
    if (report_.found.size() > 1 && !report_.round)
      report_.found.pop_back();  // the same axis again
  }

  /// The turn of a revolution that moves the most of the surface off itself.
  Pose worstTurn(const Symmetry::Axis& axis, int order) const
  {
    if (order != AxisFinding::CONTINUOUS)
      return rotationAbout(axis, angleOf(order));
    std::pair<double, Pose> worst(-1, Pose::Identity());
    for (int k = 1; k <= REVOLUTION_STEPS / 2; ++k)
    {
      const Pose T = rotationAbout(axis, angleOf(REVOLUTION_STEPS) * k);
      const double share = offShare(T);
      if (share > worst.first)
        worst = {share, T};
    }
    return worst.second;
  }

  /// Share of the surface that is moved off itself, by the field alone: fast, and blind to less than its cells.
  double offShare(const Pose& T) const { return brokenShare(surface_.queries().points, field_, T, offLimit()); }
  double offLimit() const { return std::max(tolerance(), 0.1 * static_cast<double>(field_.band())); }

  /// A half turn across the axis of revolution: about all such axes through one point of it, or about none.
  void findFlip()
  {
    const Eigen::Vector3d along = report_.symmetry.continuous->direction;
    int flattest = 0;
    along.cwiseAbs().minCoeff(&flattest);
    const Eigen::Vector3d across = along.cross(Eigen::Vector3d::Unit(flattest)).normalized();
    for (const Eigen::Vector3d& middle : {Eigen::Vector3d(inertia_.box.center()), inertia_.center})
      if (const auto axis = keptBy({across, middle}, M_PI))
      {
        addToGroup(*axis, 2);
        return;
      }
  }

  /// Else a high order is that of anything nearly round, or of a turn next to the right one, and costs a refinement.
  bool standsOut(const Symmetry::Axis& axis, int order) const
  {
    const auto distanceAt = [&](double angle) { return meanDistance(coarse_, field_, rotationAbout(axis, angle)); };
    if (order <= MAX_FEW_SIDES)
      return true;
    const double limit = 0.5 * distanceAt(angleOf(2 * order));
    for (int k = 1; k <= order / 2; ++k)
      if (distanceAt(k * angleOf(order)) >= limit)
        return false;
    return true;
  }

  void findHighestOrder(const Symmetry::Axis& candidate)
  {
    for (int order = MAX_ORDER; order >= 2; --order)
    {
      const auto axis = standsOut(candidate, order) ? keptBy(candidate, angleOf(order)) : std::nullopt;
      if (!axis)
        continue;
      addToGroup(*axis, order);
      return;
    }
  }

  /// Axes that the moments of inertia leave open, best first.
  void findUndecided()
  {
    struct Candidate
    {
      double distance;
      Symmetry::Axis axis;
      int order;
    };
    const std::vector<Eigen::Vector3d> directions = undecidedDirections(inertia_);
    const bool anywhere = directions.size() > 100;
    std::vector<Candidate> candidates;
    for (const Eigen::Vector3d& direction : directions)
      for (int order = 2; order <= (anywhere ? 5 : 2); ++order)
      {
        const Symmetry::Axis axis{direction, inertia_.center};
        candidates.push_back({meanDistance(coarse_, field_, rotationAbout(axis, angleOf(order))), axis, order});
      }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
    candidates.resize(std::min(MAX_REFINED, candidates.size()));
    for (const Candidate& candidate : candidates)
    {
      const double angle = angleOf(candidate.order);
      const Symmetry::Axis axis = refinedAxis(coarse_, field_, candidate.axis, angle, ALL);
      if (!isKnown(rotationAbout(axis, angle)) && surface_.keeps(rotationAbout(axis, angle), tolerance()))
        addToGroup(axis, candidate.order);
    }
  }

  bool isKnown(const Pose& T) const
  {
    return std::any_of(report_.symmetry.discrete.begin(), report_.symmetry.discrete.end(), [&](const Pose& element) {
      return Eigen::AngleAxisd(element.linear().transpose() * T.linear()).angle() < MEASURED.angle;
    });
  }

  /// Unless the group with it has elements that the surface contradicts: measured axes multiply their errors.
  void addToGroup(const Symmetry::Axis& axis, int order)
  {
    const Pose T = rotationAbout(axis, angleOf(order));
    if (isKnown(T))
      return;
    std::vector<Pose> generators = report_.symmetry.discrete;
    generators.push_back(T);
    try
    {
      const Symmetry grown = generateSymmetry(generators, report_.symmetry.continuous, MEASURED);
      const auto kept = [&](const Pose& element) {
        return isKnown(element) || surface_.keeps(element, 2 * tolerance());
      };
      if (!std::all_of(grown.discrete.begin(), grown.discrete.end(), kept))
        return;
      report_.symmetry = grown;
      report_.found.push_back({axis, order, surface_.mismatch(T, tolerance())});
    }
    catch (const ParameterError&)
    {
      // No finite group: one of its axes was measured too badly to be one.
    }
  }

  bool isPartOfSymmetry(const Pose& T) const
  {
    const Pose nearest = nearestEquivalent(T, Pose::Identity(), report_.symmetry);
    return Eigen::AngleAxisd(nearest.linear()).angle() < MEASURED.angle;
  }

  bool isFound(const Symmetry::Axis& axis, int order) const
  {
    return std::any_of(report_.found.begin(), report_.found.end(), [&](const AxisFinding& one) {
      return std::abs(one.axis.direction.dot(axis.direction)) > SAME_DIRECTION &&
             (one.order == AxisFinding::CONTINUOUS || (order != AxisFinding::CONTINUOUS && one.order % order == 0));
    });
  }

  /// The most that this axis nearly keeps: a revolution rather than an order, a high order rather than a low one.
  void findAlmost(const Symmetry::Axis& candidate)
  {
    const Symmetry::Axis axis = settledAxis(coarse_, field_, candidate, offLimit());
    for (int k = MAX_ORDER + 1; k >= 2; --k)
    {
      const int order = k > MAX_ORDER ? AxisFinding::CONTINUOUS : k;
      if (order != AxisFinding::CONTINUOUS && !standsOut(axis, order))
        continue;
      const Pose T = worstTurn(axis, order);
      const double share = offShare(T);
      if (share > MAX_ALMOST_SHARE || isPartOfSymmetry(T) || isFound(axis, order))
        continue;
      report_.almost.push_back({axis, order, {0, share, 0}});
      return;
    }
  }

  /// Parallel axes tell the same; the one of which least breaks tells it best.
  void keepBestAlmost()
  {
    // Where about as much breaks, the one that keeps most: a revolution, or the highest order.
    const auto rank = [](const AxisFinding& one) {
      const int order = one.order == AxisFinding::CONTINUOUS ? MAX_ORDER + 1 : one.order;
      return std::make_pair(std::lround(100 * one.mismatch.share), -order);
    };
    std::stable_sort(report_.almost.begin(), report_.almost.end(),
                     [&](const AxisFinding& a, const AxisFinding& b) { return rank(a) < rank(b); });
    std::vector<AxisFinding> kept;
    for (const AxisFinding& one : report_.almost)
      if (kept.size() < MAX_ALMOST && std::none_of(kept.begin(), kept.end(), [&](const AxisFinding& other) {
            return std::abs(other.axis.direction.dot(one.axis.direction)) > SAME_DIRECTION;
          }))
        kept.push_back({one.axis, one.order, surface_.mismatch(worstTurn(one.axis, one.order), tolerance())});
    report_.almost = kept;
  }

  const SelfComparison& surface_;
  const DistanceField& field_;
  Inertia inertia_;
  std::vector<Eigen::Vector3f> coarse_;
  SymmetryReport report_;
};
}  // namespace

SymmetryReport findSymmetry(const SelfComparison& surface, const DistanceField& field, double tolerance)
{
  return Search(surface, field, tolerance).run();
}
}  // namespace bin_picking
