// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "core/tee_scene.hpp"

namespace bin_picking
{
namespace test
{
inline std::string partFolder(const std::string& part)
{
  return std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/" + part;
}

/// The shaft of the demo: a body of revolution but for a keyway of 5 mm on its +x side.
inline const std::shared_ptr<const TrainedModel>& shaftModel()
{
  static const auto model = trainPart(loadPart(partFolder("stepped_shaft")), {}, Executor(2));
  return model;
}

/// The shaft 0.6 m before the camera, across its view, turned about its own axis. \param turn rad; 0: the keyway faces
/// the camera, pi: it is hidden behind the shaft
inline Pose shaftPose(double turn)
{
  Pose T = Pose::Identity();
  T.linear().col(0) = -Eigen::Vector3d::UnitZ();  // the keyway's side, towards the camera
  T.linear().col(2) = Eigen::Vector3d::UnitX();
  T.linear().col(1) = T.linear().col(2).cross(T.linear().col(0));
  T.translation() = Eigen::Vector3d(0, 0, 0.6) - T.linear() * shaftModel()->center;
  return T * Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ());
}

/// The angle between the axes of two shafts, rad.
inline double tiltBetween(const Pose& a, const Pose& b)
{
  return std::acos(std::min(1.0, a.linear().col(2).dot(b.linear().col(2))));
}

/// The whole angle between two poses, rad.
inline double turnBetween(const Pose& a, const Pose& b)
{
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}
}  // namespace test
}  // namespace bin_picking
