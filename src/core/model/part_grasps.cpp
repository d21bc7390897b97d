// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "part_file.hpp"

namespace bin_picking
{
namespace
{
constexpr double MAX_TRAVEL = 1.0;  // metres, of an approach or a retreat

Eigen::Matrix3d rotationFromRpy(const Eigen::Vector3d& rpy_deg)
{
  const Eigen::Vector3d rpy = rpy_deg * M_PI / 180;
  return (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

/// Z = approach, Y = closing.
Eigen::Matrix3d rotationFromDirections(const YamlMap& yaml)
{
  constexpr double MAX_SKEW = 0.02;  // sine: about 1 degree, a hand-written number of two digits
  const Eigen::Vector3d approach = yaml.direction("approach");
  const Eigen::Vector3d closing = yaml.direction("closing");
  if (std::abs(approach.dot(closing)) > MAX_SKEW)
    yaml.fail("closing", "'closing' must be at a right angle to 'approach', but the angle is " +
                             std::to_string(std::acos(approach.dot(closing)) * 180 / M_PI) + " degrees");
  Eigen::Matrix3d R;
  R.col(2) = approach;
  R.col(0) = closing.cross(approach).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

Eigen::Matrix3d readRotation(const YamlMap& yaml)
{
  const bool by_directions = yaml.has("approach") || yaml.has("closing");
  if (by_directions == yaml.has("rpy_deg"))
    yaml.fail("rpy_deg", "a grasp needs its orientation once: either 'approach' and 'closing', or 'rpy_deg'");
  return by_directions ? rotationFromDirections(yaml) : rotationFromRpy(yaml.vector("rpy_deg", ""));
}

double readLength(const YamlMap& yaml, const std::string& key, double value, double max)
{
  if (!(value >= 0 && value <= max))
    yaml.fail(
        key, "'" + key + "' is " + std::to_string(value) + " m, but it must lie in [0, " + std::to_string(max) + "] m");
  return value;
}

/// \return radians
double readTolerance(const YamlMap& yaml, const std::string& key, double max_deg)
{
  const double degrees = yaml.number(key, "", 0.0);
  if (!(degrees >= 0 && degrees <= max_deg))
    yaml.fail(key, "'" + key + "' is " + std::to_string(degrees) + " degrees, but it must lie in [0, " +
                       std::to_string(static_cast<int>(max_deg)) + "] degrees; it holds to either side");
  return degrees * M_PI / 180;
}

GraspDefinition readGrasp(const YamlMap& yaml)
{
  yaml.allowKeys({"id", "position", "rpy_deg", "approach", "closing", "width", "opening", "approach_distance",
                  "retreat_distance", "priority", "symmetric", "tilt_tolerance_deg", "spin_tolerance_deg", "around"});
  GraspDefinition grasp;
  grasp.id = yaml.text("id");
  grasp.T_object_tip.linear() = readRotation(yaml);
  grasp.T_object_tip.translation() = yaml.vector("position", "m");
  grasp.width = readLength(yaml, "width", yaml.number("width", "m"), MAX_TRAVEL);
  grasp.opening = readLength(yaml, "opening", yaml.number("opening", "m"), MAX_TRAVEL);
  if (grasp.width > grasp.opening)
    yaml.fail("width", "the grasp '" + grasp.id + "' holds at a 'width' of " + std::to_string(grasp.width) +
                           " m but comes with an 'opening' of " + std::to_string(grasp.opening) +
                           " m; the opening must be at least the width");
  grasp.approach =
      readLength(yaml, "approach_distance", yaml.number("approach_distance", "m", grasp.approach), MAX_TRAVEL);
  grasp.retreat = readLength(yaml, "retreat_distance", yaml.number("retreat_distance", "m", grasp.retreat), MAX_TRAVEL);
  grasp.priority = yaml.integer("priority", grasp.priority);
  grasp.symmetric = yaml.flag("symmetric", grasp.symmetric);
  grasp.tilt_tolerance = readTolerance(yaml, "tilt_tolerance_deg", 90);
  grasp.spin_tolerance = readTolerance(yaml, "spin_tolerance_deg", 180);
  return grasp;
}

/// Angles in degrees, 0 excepted: that is the grasp as written.
std::vector<int> readAngles(const YamlMap& around)
{
  const int from = around.integer("from_deg");
  const int to = around.integer("to_deg");
  const int step = around.integer("step_deg");
  if (from < -360 || to > 360 || from > to || to - from >= 360 + step)
    around.fail("from_deg", "the angles of 'around' go from " + std::to_string(from) + " to " + std::to_string(to) +
                                " degrees, but they must rise, lie in [-360, 360] and span one turn at most");
  if (step < 1)
    around.fail("step_deg",
                "'step_deg' is " + std::to_string(step) + ", but it must be a whole number of degrees, at least 1");
  std::vector<int> angles;
  for (int angle = from; angle <= to && angle - from < 360; angle += step)
    if (angle != 0)
      angles.push_back(angle);
  return angles;
}

/// The grasp as written and its copies turned about an axis of the part, where the part is round: named id@angle.
std::vector<GraspDefinition> withCopiesAround(const GraspDefinition& written, const YamlMap& yaml)
{
  std::vector<GraspDefinition> grasps = {written};
  if (!yaml.has("around"))
    return grasps;
  const YamlMap around = yaml.map("around");
  around.allowKeys({"axis", "origin", "from_deg", "to_deg", "step_deg"});
  const Eigen::Vector3d origin = around.has("origin") ? around.vector("origin", "m") : Eigen::Vector3d::Zero();
  const Symmetry::Axis axis{around.direction("axis"), origin};
  for (const int angle : readAngles(around))
  {
    GraspDefinition copy = written;
    copy.id += "@" + std::to_string(angle);
    copy.copy_of = written.id;
    copy.T_object_tip = rotationAbout(axis, angle * M_PI / 180) * written.T_object_tip;
    grasps.push_back(copy);
  }
  return grasps;
}
}  // namespace

std::vector<GraspDefinition> readGrasps(const YamlMap& part)
{
  std::vector<GraspDefinition> grasps;
  std::set<std::string> ids;
  for (const YamlMap& entry : part.list("grasps"))
    for (const GraspDefinition& grasp : withCopiesAround(readGrasp(entry), entry))
    {
      grasps.push_back(grasp);
      if (!ids.insert(grasp.id).second)
        entry.fail("id", "the grasp id '" + grasp.id + "' is used twice; ids must differ");
    }
  return grasps;
}
}  // namespace bin_picking
