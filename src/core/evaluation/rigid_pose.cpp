// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "rigid_pose.hpp"

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
std::string rigidityFault(const Eigen::Matrix3d& R, const Eigen::Vector3d& t)
{
  constexpr double ROUNDING = 1e-3;
  if (!R.allFinite() || !t.allFinite())
    return "has entries that are not finite numbers; a pose that is not known must be left out";
  const double deviation = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (deviation > ROUNDING)
    return "is no rotation: R^T R differs from the identity by " + std::to_string(deviation) +
           ", and at most 0.001 is taken as rounding; write R row by row, without scale";
  if (R.determinant() < 0)
    return "is a mirror image (the determinant of R is -1), which no motion of a part can reach; check the axes and "
           "the order of the entries of R";
  return {};
}

Pose rigidPose(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, const std::string& origin)
{
  const std::string fault = rigidityFault(R, t);
  if (!fault.empty())
    throw FileError(origin + " " + fault + ".");
  Pose T = Pose::Identity();
  T.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();  // the digits that the file left away
  T.translation() = t;
  return T;
}
}  // namespace bin_picking
