// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <cmath>

#include "../common/yaml_reader.hpp"
#include "bin_picking_perception/robot/kinematics.hpp"

namespace bin_picking
{
namespace
{
constexpr int ROBOT_FORMAT = 1;

/// Right angles that were written in degrees, exactly.
double snapped(double angle)
{
  const double right_angles = std::round(angle / M_PI_2);
  return std::abs(angle - right_angles * M_PI_2) < 1e-9 ? right_angles * M_PI_2 : angle;
}

void readJoint(const YamlMap& yaml, Eigen::Index k, Robot& robot)
{
  yaml.allowKeys({"name", "a", "d", "alpha", "lower", "upper", "home"});
  const auto index = static_cast<std::size_t>(k);
  robot.joint_names[index] = yaml.text("name");
  robot.dh[index] = {yaml.number("a", "m"), yaml.number("d", "m"), snapped(yaml.number("alpha", "rad"))};
  robot.lower[k] = yaml.number("lower", "rad");
  robot.upper[k] = yaml.number("upper", "rad");
  robot.home[k] = yaml.number("home", "rad");
  if (!(robot.home[k] >= robot.lower[k] && robot.home[k] <= robot.upper[k]))
    yaml.fail("home", "'home' of the joint '" + robot.joint_names[index] + "' is " + std::to_string(robot.home[k]) +
                          " rad, but it must lie between its limits 'lower' and 'upper', [" +
                          std::to_string(robot.lower[k]) + ", " + std::to_string(robot.upper[k]) + "] rad");
}
}  // namespace

Robot loadRobot(const std::string& path)
{
  const YamlMap yaml = YamlMap::load(path);
  yaml.allowKeys({"format", "name", "joints", "base_link_to_base"});
  if (const int format = yaml.integer("format"); format != ROBOT_FORMAT)
    yaml.fail("format", "the format is " + std::to_string(format) + ", but this program reads format " +
                            std::to_string(ROBOT_FORMAT) + "; use the release that the file was written for");
  Robot robot;
  robot.name = yaml.text("name");
  const std::vector<YamlMap> joints = yaml.list("joints");
  if (joints.size() != 6)
    yaml.fail("joints", "the robot has " + std::to_string(joints.size()) + " 'joints', but there must be 6");
  for (std::size_t k = 0; k < 6; ++k)
    readJoint(joints[k], static_cast<Eigen::Index>(k), robot);
  const YamlMap turn = yaml.map("base_link_to_base");
  turn.allowKeys({"rotation_z"});
  robot.T_base_link_base.linear() =
      Eigen::AngleAxisd(turn.number("rotation_z", "rad"), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  if (const std::string fault = geometryFault(robot); !fault.empty())
    yaml.fail("joints", fault);
  return robot;
}
}  // namespace bin_picking
