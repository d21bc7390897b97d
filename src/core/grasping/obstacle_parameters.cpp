// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/obstacles.hpp"

namespace bin_picking
{
void ObstacleParameters::visit(ParameterVisitor& v)
{
  v.field({"bin_clearance", "m",
           "smallest distance of the gripper to walls and floor on the whole way; larger gives up parts near the walls",
           0, 0.1},
          bin_clearance);
  v.field({"surface_clearance", "m",
           "smallest distance of the gripper to measured points; larger keeps off noise and what lies between pixels",
           -0.01, 0.004},
          surface_clearance);
  v.field({"part_clearance", "m",
           "smallest distance of the gripper to other detected parts; larger allows for errors of their poses", -0.01,
           0.004},
          part_clearance);
  v.field({"target_clearance", "m",
           "smallest distance of the open gripper to the part that it takes; negative tolerates errors of its pose",
           -0.01, 0.004},
          target_clearance);
  v.field({"unseen_entry", "m",
           "how far the gripper may enter space that the camera did not see; larger offers more grasps and risks to "
           "touch what is hidden",
           0, 0.1},
          unseen_entry);
  v.field({"shadow_entry", "m",
           "the same where only the part to be taken hides the space: fingers that straddle it get there", 0, 0.1},
          shadow_entry);
  v.field(
      {"unknown_entry", "m",
       "the same where neither a detected part nor the bin hides the space: of what does, the far side is not known", 0,
       0.1},
      unknown_entry);
  v.field({"target_tolerance", "m",
           "measured points this close to the surface of the part to be taken are its own; larger tolerates errors of "
           "its pose and misses what touches it",
           0.0005, 0.01},
          target_tolerance);
  v.field({"max_drag", "m",
           "how much deeper than at rest the held part may get into others on the way out; larger tolerates errors of "
           "poses",
           0, 0.02},
          max_drag);
}

const char* toString(ObstacleKind kind)
{
  switch (kind)
  {
    case ObstacleKind::None:
      return "none";
    case ObstacleKind::BinFloor:
      return "bin_floor";
    case ObstacleKind::BinWall:
      return "bin_wall";
    case ObstacleKind::Surface:
      return "surface";
    case ObstacleKind::Unknown:
      return "unknown";
    case ObstacleKind::Part:
      return "part";
    case ObstacleKind::Target:
      return "target";
  }
  return "unknown";
}
}  // namespace bin_picking
