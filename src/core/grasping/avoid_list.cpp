// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/avoid_list.hpp"

#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
void AvoidParameters::visit(ParameterVisitor& v)
{
  v.field({"radius", "m",
           "parts whose middle lies that near to the middle of a part that could not be taken are not offered; larger "
           "leaves more neighbours alone, smaller may miss a part that was pushed; 0: nothing is avoided",
           0, 0.5},
          radius);
  v.field({"duration", "s", "how long a place is avoided after an attempt that failed", 0, 86400}, duration);
  v.field(
      {"picks", "", "successful picks elsewhere after which the pile has changed and a place is tried again", 1, 1000},
      picks);
  v.field({"duration_not_attempted", "s", "how long a place is avoided that the robot did not try", 0, 86400},
          duration_not_attempted);
}

const char* toString(PickOutcome outcome)
{
  switch (outcome)
  {
    case PickOutcome::Picked:
      return "picked";
    case PickOutcome::Missed:
      return "missed";
    case PickOutcome::Dropped:
      return "dropped";
    case PickOutcome::Collision:
      return "collision";
    case PickOutcome::NotAttempted:
      return "not attempted";
  }
  return "unknown";
}

AvoidList::AvoidList(const AvoidParameters& parameters) : parameters_(parameters) { checkRanges(parameters); }

void AvoidList::report(PickOutcome outcome, const Eigen::Vector3d& center, double now, const std::string& part)
{
  if (!center.allFinite() || !std::isfinite(now))
    throw ParameterError("The place or the time of an attempt is not finite; it has to be that of a detection.");
  tick(now);
  if (outcome == PickOutcome::Picked)
  {
    for (AvoidedPlace& place : places_)
      --place.picks_left;
    tick(now);
    forgetNear(center);
    return;
  }
  if (parameters_.radius <= 0)
    return;
  const double duration =
      outcome == PickOutcome::NotAttempted ? parameters_.duration_not_attempted : parameters_.duration;
  // That the robot did not try again says nothing against what it met there before.
  if (outcome == PickOutcome::NotAttempted && lastsNear(center, now + duration))
    return;
  forgetNear(center);
  if (places_.size() >= MAX_PLACES)
    places_.erase(places_.begin());
  places_.push_back({center, parameters_.radius, now, now + duration, parameters_.picks, outcome, part});
}

void AvoidList::tick(double now)
{
  const auto expired = [now](const AvoidedPlace& p) { return now >= p.until || now < p.since || p.picks_left <= 0; };
  places_.erase(std::remove_if(places_.begin(), places_.end(), expired), places_.end());
}

void AvoidList::forgetNear(const Eigen::Vector3d& center)
{
  const auto near = [&center](const AvoidedPlace& p) { return (p.center - center).norm() <= p.radius; };
  places_.erase(std::remove_if(places_.begin(), places_.end(), near), places_.end());
}

bool AvoidList::lastsNear(const Eigen::Vector3d& center, double until) const
{
  return std::any_of(places_.begin(), places_.end(),
                     [&](const AvoidedPlace& p) { return (p.center - center).norm() <= p.radius && p.until > until; });
}

const AvoidedPlace* AvoidList::find(const Eigen::Vector3d& point) const
{
  for (auto place = places_.rbegin(); place != places_.rend(); ++place)
    if ((place->center - point).norm() <= place->radius)
      return &*place;
  return nullptr;
}
}  // namespace bin_picking
