// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "grip_trial.hpp"

namespace bin_picking::simulation
{
void GripTrialParameters::visit(ParameterVisitor& v)
{
  v.field({"max_push", "m", "how far one finger alone may push the part until the other one touches it", 0, 0.05},
          max_push);
  v.field(
      {"max_width_error", "m", "how far the opening at which the fingers stop may be from the one meant", 1e-4, 0.05},
      max_width_error);
  v.field(
      {"friction", "", "coefficient of friction between fingers and parts; smaller calls more grips slipping", 0.01, 2},
      friction);
  v.field({"contact_depth", "m",
           "how deep the pads press in for the surface that they hold; larger stands for softer pads", 1e-5, 0.01},
          contact_depth);
  v.field({"max_drag", "m", "how much deeper than at rest the held part may reach into another part", 0, 0.1},
          max_drag);
  v.field({"bin_play", "m", "how much deeper than at rest the held part may reach into the bin", 0, 0.01}, bin_play);
  v.field(
      {"closing_step", "m", "of the opening, between the places at which closing fingers are looked at", 1e-5, 0.001},
      closing_step);
  v.field({"retreat_step", "m", "between the places at which the held part is held against others", 1e-4, 0.005},
          retreat_step);
  v.field({"seal_gap", "m", "how far the surface may be from a suction lip that seals", 1e-5, 0.02}, seal_gap);
  v.field({"seal_angle", "rad", "between the surface and a suction lip that seals", 0, 1.5}, seal_angle);
}

const char* toString(GripVerdict::Outcome outcome)
{
  switch (outcome)
  {
    case GripVerdict::Outcome::Taken:
      return "taken";
    case GripVerdict::Outcome::Missed:
      return "missed";
    case GripVerdict::Outcome::Collision:
      return "collision";
  }
  return "unknown";
}

const char* toString(GripStage stage)
{
  switch (stage)
  {
    case GripStage::Approach:
      return "approach";
    case GripStage::Closing:
      return "closing";
    case GripStage::Retreat:
      return "retreat";
  }
  return "unknown";
}

const char* toString(GripObstacle obstacle)
{
  switch (obstacle)
  {
    case GripObstacle::None:
      return "none";
    case GripObstacle::Bin:
      return "bin";
    case GripObstacle::Target:
      return "target";
    case GripObstacle::Part:
      return "part";
  }
  return "unknown";
}
}  // namespace bin_picking::simulation
