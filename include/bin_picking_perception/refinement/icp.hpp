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
  double error_spacing = 9;       // raw pixels

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

/// All measured points in that box.
OrientedPoints surfaceNear(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid,
                           const std::vector<Eigen::Vector3f>& normals);

/// ICP of measured points against the distance field of the part, which knows the nearest point of its surface for
/// every place (Fitzgibbon 2003): Gauss-Newton on the distances, robust (Tukey's biweight), the gate closing from
/// max_distance to min_distance. Where the surface lets the part slide, as a flat face does in its own plane, its
/// outline holds it: a place that lies a step outside of a measured edge should lie a step off the part.
/// Directions that nothing holds (a tube of which no end is in view) are left as they were.
IcpResult icpDistanceField(const TrainedModel& model, const MeasuredPart& measured, const Pose& initial,
                           const IcpParameters& parameters);

/// Least squares takes the errors of all points for independent, but a sensor's are alike over many pixels: then the
/// many points of a smooth face outvote the few that know better. One Gauss-Newton step of generalised least squares,
/// with the smooth part of the error as unknowns beside the pose: values at the nodes of a grid in the picture, in
/// between interpolated (semiparametric regression; Ruppert, Wand and Carroll 2003). What the errors leave open stays
/// as it was, and so does all where the step would be long: it corrects tenths of a millimetre. Outlines take no part:
/// what they err by is alike all around the part, which no node explains. Where points are fewer than nodes, all stays.
/// \param surface surfaceNear of a grid that has some pixels between any two nodes
/// \param refined by icpDistanceField
/// \param spacing of the nodes, tangent of the angle between their rays; about the length over which errors are alike
Pose fitBesideSmoothErrors(const TrainedModel& model, const OrientedPoints& surface, const Pose& refined,
                           double spacing, const IcpParameters& parameters);
}  // namespace bin_picking
