// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "bin_picking_perception/scene/depth_edges.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
class KdTree;

enum class IcpMethod
{
  None,
  PointToPoint,  ///< Besl and McKay 1992, nearest neighbours: the paper's choice
  DistanceField  ///< measured points against the part's distance field
};

struct IcpParameters
{
  IcpMethod method = IcpMethod::DistanceField;
  int max_iterations = 10;
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
IcpResult icpPointToPoint(const KdTree& model, const OrientedPoints& scene, const Pose& initial, double max_distance,
                          const IcpParameters& parameters);

/// What was measured where a part may be, camera frame.
struct MeasuredPart
{
  OrientedPoints surface;  ///< with the measured normals
  OrientedPoints edges;    ///< points of outlines; "normals" point outward in the picture, across the viewing ray
};

/// The measurements in the box of the part at a pose, grown by the band of its distance field.
/// \param normals, edges of that grid. \param max_pixels about so many pixels at most are looked at, evenly
MeasuredPart measuredNear(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid,
                          const std::vector<Eigen::Vector3f>& normals, const DepthEdges& edges, std::size_t max_pixels);

/// ICP of measured points against the distance field of the part, which knows the nearest point of its surface for
/// every place (Fitzgibbon 2003): Gauss-Newton on the distances, robust (Tukey's biweight), the gate closing from
/// max_distance to min_distance. Where the surface lets the part slide, as a flat face does in its own plane, its
/// outline holds it: a place that lies a step outside of a measured edge should lie a step off the part.
/// Directions that nothing holds (a tube of which no end is in view) are left as they were.
IcpResult icpDistanceField(const TrainedModel& model, const MeasuredPart& measured, const Pose& initial,
                           const IcpParameters& parameters);
}  // namespace bin_picking
