// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "view_camera.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
/// Parallel to 0.3 % of sizes, and near enough that single precision tells depths of a millionth of the part.
constexpr double DISTANCE_IN_DIAMETERS = 200;
constexpr int MIN_SIDE = 8;  // pixels across the part: fewer say nothing about its shape
constexpr int MAX_SIDE = 4096;
constexpr int MARGIN = 4;  // pixels of background on each side
}  // namespace

ViewCamera::ViewCamera(const std::vector<Eigen::Vector3f>& points, double pixel_size) : pixel(pixel_size)
{
  Eigen::Vector3f low = points.front();
  Eigen::Vector3f high = low;
  for (const auto& p : points)
  {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  center = (low + high).cast<double>() / 2;
  double radius = 0;
  for (const auto& p : points)
    radius = std::max(radius, (p.cast<double>() - center).norm());
  const double pixels_across = 2 * radius / pixel;
  if (!(pixels_across >= MIN_SIDE && pixels_across <= MAX_SIDE))
    throw ParameterError("with view pixels of " + std::to_string(pixel * 1e3) + " mm the part is " +
                         std::to_string(pixels_across) + " pixels across, but it must be between " +
                         std::to_string(MIN_SIDE) + " and " + std::to_string(MAX_SIDE) +
                         "; change the spacing of the surface points");
  distance = DISTANCE_IN_DIAMETERS * 2 * radius;
  // The near side of the part appears a little larger.
  side = static_cast<int>(std::ceil(pixels_across * (1 + 1 / DISTANCE_IN_DIAMETERS))) + 2 * MARGIN;
  const double focal_length = distance / pixel;
  intrinsics = {focal_length, focal_length, (side - 1) / 2.0, (side - 1) / 2.0};
}

Pose ViewCamera::poseOfObject(const Eigen::Vector3d& direction) const
{
  Eigen::Matrix3d R;
  R.row(2) = -direction;
  R.row(0) = direction.unitOrthogonal();
  R.row(1) = R.row(2).cross(R.row(0));
  Pose T = Pose::Identity();
  T.linear() = R;
  T.translation() = -R * (center + distance * direction);
  return T;
}
}  // namespace bin_picking
