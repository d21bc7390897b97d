// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
enum class IcpMethod
{
  None,
  PointToPoint,  ///< Besl and McKay 1992, nearest neighbours: the paper's choice
  Projective     ///< point to plane on the organized grid
};

struct IcpParameters
{
  IcpMethod method = IcpMethod::Projective;
  int max_iterations = 20;
  double max_distance = 1.5;      // of the leaf: start of the correspondence gate
  double min_distance = 0.5;      // of the leaf: its end
  double max_normal_angle = 0.8;  // rad
  double convergence = 1e-5;      // metres of motion of the surface

  void visit(ParameterVisitor& v);
};

struct IcpResult
{
  Pose T_camera_object = Pose::Identity();
  int iterations = 0;
  int correspondences = 0;
  double rms = 0;  ///< metres; NaN without correspondences
  bool converged = false;
};

/// Point-to-point ICP of scene points against model points. \param max_distance metres
IcpResult icpPointToPoint(const OrientedPoints& model, const OrientedPoints& scene, const Pose& initial,
                          double max_distance, const IcpParameters& parameters);

/// Point-to-plane ICP with projective association on the grid. Directions in which the surface does not hold the part (a
/// cylinder's axis) are left as they were. \param facing the points of `model` that face the camera at the initial pose
/// \param leaf scales the correspondence gate, metres
IcpResult icpProjective(const OrientedPoints& model, const std::vector<std::uint32_t>& facing, const DepthGrid& grid,
                        const std::vector<Eigen::Vector3f>& normals, const Pose& initial, double leaf,
                        const IcpParameters& parameters);
}  // namespace bin_picking
