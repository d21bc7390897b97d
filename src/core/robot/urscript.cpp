// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/robot/urscript.hpp"

#include <array>
#include <cmath>
#include <locale>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/figures.hpp"
#include "bin_picking_perception/robot/kinematics.hpp"

namespace bin_picking
{
namespace
{
constexpr double HALF_TURN_TOLERANCE = 1e-9;

/// Without an exponent, which URScript does not promise to read.
std::string decimal(double value) { return shortText(value, 10); }

void requirePositive(double value, const char* what, const char* unit)
{
  if (!(value > 0) || !std::isfinite(value))
    throw ParameterError(std::string("the ") + what + " of a move is " + std::to_string(value) + " " + unit +
                         ", but it must be positive");
}
}  // namespace

Eigen::Vector3d rotationVector(const Eigen::Matrix3d& rotation)
{
  const Eigen::AngleAxisd turn(rotation);
  Eigen::Vector3d vector = turn.angle() * turn.axis();
  if (turn.angle() < M_PI - HALF_TURN_TOLERANCE)
    return vector;
  for (int k = 0; k < 3; ++k)
    if (std::abs(vector[k]) > HALF_TURN_TOLERANCE)
      return vector[k] < 0 ? Eigen::Vector3d(-vector) : vector;
  return vector;
}

Eigen::Matrix3d rotationFromVector(const Eigen::Vector3d& vector)
{
  const double angle = vector.norm();
  if (!(angle > 0))
    return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

std::string toUrScript(const Pose& T_base_tcp)
{
  requireRigid(T_base_tcp, "the pose that is to be written in URScript");
  const Eigen::Vector3d p = T_base_tcp.translation();
  const Eigen::Vector3d r = rotationVector(T_base_tcp.linear());
  return "p[" + decimal(p.x()) + ", " + decimal(p.y()) + ", " + decimal(p.z()) + ", " + decimal(r.x()) + ", " +
         decimal(r.y()) + ", " + decimal(r.z()) + "]";
}

std::string toUrScriptMove(const Pose& T_base_tcp, double acceleration, double speed)
{
  requirePositive(acceleration, "acceleration", "m/s^2");
  requirePositive(speed, "speed", "m/s");
  return "movel(" + toUrScript(T_base_tcp) + ", a=" + decimal(acceleration) + ", v=" + decimal(speed) + ")";
}

Pose fromUrScript(const std::string& text)
{
  const auto fail = [&]() -> ParameterError {
    return ParameterError("'" + text +
                          "' has no pose p[x, y, z, rx, ry, rz] of six finite numbers; metres and radians");
  };
  const std::size_t begin = text.find("p[");
  if (begin == std::string::npos)
    throw fail();
  std::istringstream stream(text.substr(begin + 2));
  stream.imbue(std::locale::classic());
  std::array<double, 6> values{};
  for (std::size_t k = 0; k < 6; ++k)
  {
    char separator = 0;
    if (!(stream >> values[k] >> separator) || separator != (k < 5 ? ',' : ']') || !std::isfinite(values[k]))
      throw fail();
  }
  Pose pose = Pose::Identity();
  pose.linear() = rotationFromVector({values[3], values[4], values[5]});
  pose.translation() = Eigen::Vector3d(values[0], values[1], values[2]);
  return pose;
}
}  // namespace bin_picking
