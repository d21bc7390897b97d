// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/undetermined_turn.hpp"

#include <cmath>

#include "axis_text.hpp"
#include "bin_picking_perception/common/figures.hpp"

namespace bin_picking
{
namespace
{
constexpr int REVOLUTION_STEPS = 360;

/// Not turned, then turned by each of the angles.
std::vector<Pose> turnsOf(const UndeterminedTurn& turn, int steps)
{
  std::vector<Pose> turns = {Pose::Identity()};
  for (const double angle : turn.angles)
    turns.push_back(rotationAbout(turn.axis, angle));
  if (turn.angles.empty())
    for (int k = 1; k < steps; ++k)
      turns.push_back(rotationAbout(turn.axis, 2 * M_PI * k / steps));
  return turns;
}

/// Of T turned freely about the axis, then moved by the symmetric motion g, the pose nearest to the reference: turning
/// before g is turning after it about the axis that g brings to its place.
Pose nearestTurnedFreely(const Pose& T, const Pose& reference, const Symmetry::Axis& axis, const Pose& g)
{
  const Pose back = g.inverse();
  Symmetry free_turn;
  free_turn.continuous = Symmetry::Axis{back.linear() * axis.direction, back * axis.origin};
  return nearestEquivalent(T * g, reference, free_turn);
}
}  // namespace

std::string describe(const UndeterminedTurn& turn)
{
  const std::string about = "about the axis " + axisText(turn.axis);
  std::string text;
  if (turn.angles.empty())
    text = "its turn " + about + " is not known";
  else
  {
    for (const double angle : turn.angles)
      text += (text.empty() ? "it may as well be turned by " : " or ") + roundedText(angle * 180 / M_PI, 0);
    text += " deg " + about;
  }
  return text + ": what tells it, up to " + millimetres(turn.deviation, 2) + " high or deep, is not seen";
}

std::vector<Pose> sampledTurns(const UndeterminedTurn& turn, const Symmetry& symmetry, int steps)
{
  std::vector<Pose> all;
  const std::vector<Pose> symmetric = symmetry.sampled(steps);
  for (const Pose& T : turnsOf(turn, steps))
    for (const Pose& g : symmetric)
      all.push_back(T * g);
  return all;
}

Pose nearestTurned(const Pose& T_camera_object, const Pose& reference, const UndeterminedTurn& turn,
                   const Symmetry& symmetry)
{
  std::vector<Pose> candidates;
  if (turn.angles.empty())
    for (const Pose& g : symmetry.sampled(REVOLUTION_STEPS))
      candidates.push_back(nearestTurnedFreely(T_camera_object, reference, turn.axis, g));
  else
    for (const Pose& T : turnsOf(turn, 1))
      candidates.push_back(nearestEquivalent(T_camera_object * T, reference, symmetry));
  Pose best = candidates.front();
  double best_trace = -2;
  for (const Pose& candidate : candidates)
    if (const double trace = (reference.linear().transpose() * candidate.linear()).trace(); trace > best_trace)
    {
      best_trace = trace;
      best = candidate;
    }
  return best;
}
}  // namespace bin_picking
