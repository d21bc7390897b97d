// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
/// What cameras all around a part have in common. They are so far away (200 diameters) that the projection is nearly
/// parallel: sizes in metres then hold for any distance.
struct ViewCamera
{
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< that the cameras look at, part frame
  double distance = 0;                               ///< metres from there
  int side = 0;                                      ///< pixels
  double pixel = 0;                                  ///< metres at the center
  PinholeCamera intrinsics;

  /// \param points of the part; all of them project into the image. \param pixel edge of a pixel at the part, metres
  /// \throws ParameterError a pixel too small or too large for the part
  ViewCamera(const std::vector<Eigen::Vector3f>& points, double pixel);

  /// \param direction from the part towards the camera, part frame, unit
  Pose poseOfObject(const Eigen::Vector3d& direction) const;
};
}  // namespace bin_picking
