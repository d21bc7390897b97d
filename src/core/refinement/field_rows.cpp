// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "field_rows.hpp"

namespace bin_picking
{
Pose movedBy(const Vector6d& x, const Pose& T_object_camera, const TrainedModel& model)
{
  const Eigen::Vector3d rotation = x.head<3>() / FieldRows::radius(model);
  const double angle = rotation.norm();
  Pose step = Pose::Identity();
  if (angle > 0)
    step.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  step.translation() = model.center - step.linear() * model.center + x.tail<3>();
  Pose T = step * T_object_camera;
  // Products of rotations drift; the nearest rotation keeps the pose rigid.
  T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  return T;
}
}  // namespace bin_picking
