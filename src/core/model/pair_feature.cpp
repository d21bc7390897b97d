// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/pair_feature.hpp"

namespace bin_picking
{
float angleBetween(const Eigen::Vector3f& a, const Eigen::Vector3f& b)
{
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

PairFeature pairFeature(const Eigen::Vector3f& p1, const Eigen::Vector3f& n1, float q1, const Eigen::Vector3f& p2,
                        const Eigen::Vector3f& n2, float q2)
{
  const Eigen::Vector3f d = p2 - p1;
  return {d.norm(), angleBetween(n1, d), angleBetween(n2, d), angleBetween(n1, n2), q1, q2};
}

Eigen::Isometry3f alignToLocalFrame(const Eigen::Vector3f& p, const Eigen::Vector3f& n)
{
  // Rotation about n x (1, 0, 0); for n = -x any axis in the plane will do, and y is taken.
  const Eigen::Vector3f axis(0, n.z(), -n.y());
  const float sine = axis.norm();
  Eigen::Matrix3f R;
  if (sine > 1e-6f)
    R = Eigen::AngleAxisf(std::atan2(sine, n.x()), axis / sine).toRotationMatrix();
  else
    R = n.x() > 0 ? Eigen::Matrix3f::Identity()
                  : Eigen::AngleAxisf(static_cast<float>(M_PI), Eigen::Vector3f::UnitY()).toRotationMatrix();
  Eigen::Isometry3f T = Eigen::Isometry3f::Identity();
  T.linear() = R;
  T.translation() = -(R * p);
  return T;
}
}  // namespace bin_picking
