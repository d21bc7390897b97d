// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "pose_conversion.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "return_code.hpp"

namespace bin_picking_ros
{
namespace
{
using bin_picking::Pose;

Eigen::Quaterniond rotationOf(const Pose& pose)
{
  if (!pose.matrix().allFinite())
    throw std::logic_error("A pose that is not finite was about to be sent.");
  const Eigen::Quaterniond q = Eigen::Quaterniond(pose.linear()).normalized();
  // Of the two quaternions of a rotation the one with w >= 0, so that equal poses have equal messages.
  return q.w() < 0 ? Eigen::Quaterniond(-q.coeffs()) : q;
}

template <typename Vector, typename Quaternion>
Pose makePose(const Vector& position, const Quaternion& orientation)
{
  const Eigen::Vector3d p(position.x, position.y, position.z);
  const Eigen::Quaterniond q(orientation.w, orientation.x, orientation.y, orientation.z);
  if (!p.allFinite() || !q.coeffs().allFinite())
    throw RequestError(ReturnCode::INVALID_ARGUMENT, "A received pose holds a number that is not finite.");
  if (std::abs(q.norm() - 1.0) > 1e-3)
    throw RequestError(ReturnCode::INVALID_ARGUMENT, "A received quaternion has length " + std::to_string(q.norm()) +
                                                         "; it must be 1 (within 0.001).");
  Pose pose = Pose::Identity();
  pose.linear() = q.normalized().toRotationMatrix();
  pose.translation() = p;
  return pose;
}

template <typename Quaternion>
void assign(const Eigen::Quaterniond& q, Quaternion& message)
{
  message.x = q.x();
  message.y = q.y();
  message.z = q.z();
  message.w = q.w();
}
}  // namespace

geometry_msgs::Pose toPoseMessage(const Pose& pose)
{
  geometry_msgs::Pose message;
  assign(rotationOf(pose), message.orientation);
  message.position.x = pose.translation().x();
  message.position.y = pose.translation().y();
  message.position.z = pose.translation().z();
  return message;
}

geometry_msgs::Transform toTransformMessage(const Pose& pose)
{
  geometry_msgs::Transform message;
  assign(rotationOf(pose), message.rotation);
  message.translation.x = pose.translation().x();
  message.translation.y = pose.translation().y();
  message.translation.z = pose.translation().z();
  return message;
}

Pose fromMessage(const geometry_msgs::Pose& message) { return makePose(message.position, message.orientation); }

Pose fromMessage(const geometry_msgs::Transform& message) { return makePose(message.translation, message.rotation); }
}  // namespace bin_picking_ros
