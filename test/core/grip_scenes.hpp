// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bin_picking_perception/grasping/convex_body.hpp"
#include "core/mesh_shapes.hpp"
#include "grip_trial.hpp"

namespace bin_picking
{
namespace test
{
/// Two straight fingers, 20 mm broad, that reach 8 mm beyond the tip, 150 mm below the flange, and a palm.
inline Gripper twoFingers()
{
  Gripper gripper;
  gripper.name = "two_fingers";
  gripper.max_opening = 0.1;
  gripper.tip_heights = {{0, 0.15}};
  GripperBody palm;
  palm.name = "palm";
  palm.shape = makeBox({0, 0, 0.04}, {0.06, 0.12, 0.08});
  gripper.bodies.push_back(palm);
  for (const double side : {1.0, -1.0})
  {
    GripperBody finger;
    finger.name = side > 0 ? "right finger" : "left finger";
    finger.shape = makeBox({0, side * 0.005, 0.119}, {0.02, 0.01, 0.078});
    finger.placements = {{0, Eigen::Vector3d::Zero(), 0}, {0.1, Eigen::Vector3d(0, side * 0.05, 0), 0}};
    finger.touches_part = true;
    gripper.bodies.push_back(finger);
  }
  return gripper;
}

/// A cup of 20 mm across on a stem, 100 mm below the flange.
inline Gripper suctionCup()
{
  Gripper gripper;
  gripper.name = "suction_cup";
  gripper.kind = Gripper::Kind::Suction;
  gripper.tip_heights = {{0, 0.1}};
  GripperBody stem;
  stem.name = "stem";
  stem.shape = makeBox({0, 0, 0.045}, {0.01, 0.01, 0.09});
  GripperBody lip;
  lip.name = "lip";
  lip.shape = makeBox({0, 0, 0.095}, {0.02, 0.02, 0.01});
  lip.touches_part = true;
  gripper.bodies = {stem, lip};
  return gripper;
}

inline Pose at(double x, double y, double z, double turn_about_z = 0)
{
  Pose T = Pose::Identity();
  T.translation() = Eigen::Vector3d(x, y, z);
  T.linear() = Eigen::AngleAxisd(turn_about_z, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

/// Parts in a bin of 400 x 300 x 150 mm.
class GripScenario
{
public:
  /// \return the id
  int add(const TriangleMesh& mesh, const Pose& T_bin_object, const std::string& name = "block")
  {
    const int id = static_cast<int>(bodies.size());
    parts.push_back({name, std::make_shared<TriangleMesh>(mesh)});
    bodies.push_back({id, id, T_bin_object});
    return id;
  }

  simulation::GripVerdict tryGrip(const simulation::GripPath& path, int id_meant) const
  {
    Bin bin;
    bin.inner_size = {0.4, 0.3, 0.15};
    bin.wall_thickness = wall_thickness;
    return simulation::GripJudge(parts, bin, 0).tryGrip(bodies, gripper, path, id_meant, parameters);
  }

  /// Straight down with Y of the tip along y of the bin, turned by `turn`; the tip ends at `tip`; straight up.
  simulation::GripPath fromAbove(const Eigen::Vector3d& tip, double opening, double width, double turn = 0) const
  {
    Pose T_bin_tip = at(tip.x(), tip.y(), tip.z(), turn) * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY());
    simulation::GripPath path;
    path.T_bin_tool0_grasp = T_bin_tip * gripper.T_tool0_tip(width).inverse();
    path.T_bin_tool0_pre_grasp = Eigen::Translation3d(0, 0, 0.08) * path.T_bin_tool0_grasp;
    path.T_bin_tool0_retreat = Eigen::Translation3d(0, 0, 0.12) * path.T_bin_tool0_grasp;
    path.opening = opening;
    path.width = width;
    return path;
  }

  std::vector<simulation::CellPart> parts;
  std::vector<simulation::Body> bodies;
  double wall_thickness = 0.005;
  Gripper gripper = twoFingers();
  simulation::GripTrialParameters parameters;
};
}  // namespace test
}  // namespace bin_picking
