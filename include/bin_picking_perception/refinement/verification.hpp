// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "bin_picking_perception/scene/bin.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
class KdTree;

struct VerificationParameters
{
  bool enabled = true;  // false: only the matching rate decides, as in the paper
  double match_distance = 0.005;
  double min_matching_rate = 0.5;
  double depth_tolerance = 0.15;
  double noise_tolerance = 5;
  double max_normal_angle = 0.7;
  double min_outline_share = 0.3;
  double min_score = 0.7;
  double min_visible_fraction = 0.3;
  double min_inlier_share = 0.75;
  double max_violation_share = 0.2;
  double unmeasured_weight = 0.3;
  double min_turn_margin = 14;
  bool accept_undetermined_turns = true;
  double min_surface_share = 0.8;
  double max_continued_share = 0.01;
  double max_bin_penetration = 0.006;
  double overlap = 0.35;
  int max_refined = 96;
  int fruitless_rounds = 3;

  void visit(ParameterVisitor& v);
};

/// A pose held against the grid: what became of the part's surface, in points, each weighted by the cosine under which
/// the camera sees it. So a face counts by its share of the picture, not by its area: what is seen edge-on has few
/// pixels.
struct PoseEvidence
{
  double facing = 0;        ///< would be seen if nothing were in front
  double explained = 0;     ///< measured there, normal agrees
  double misfit = 0;        ///< measured near there, but off the surface or with another normal
  double occluded = 0;      ///< something nearer was measured: neither for nor against
  double violated = 0;      ///< something farther was measured: the part cannot be there
  double unmeasured = 0;    ///< no data (or outside of the picture)
  double matched = 0;       ///< measured, not occluded, and within the distance of Equation 9
  double rms = 0;           ///< point-to-plane residual of the explained points, metres
  std::vector<int> pixels;  ///< of the explained points, in their order

  /// Explained among all that speak for or against the pose, [0, 1].
  double inlierShare(double unmeasured_weight) const;
  double visibleFraction() const { return facing > 0 ? explained / facing : 0; }
  double violationShare() const;
  /// Equation 9 with the measured, not occluded pixels under the part as "object points in the scene".
  double matchingRate() const;
};

/// The view of the part that is nearest to what the camera sees at this pose.
const ViewTemplate& nearestView(const TrainedModel& model, const Pose& T_camera_object);

/// Points of TrainedModel::surface, by index.
using SurfaceIndices = std::vector<std::uint32_t>;

/// Every step-th surface point of the nearest view so that about max_points remain.
SurfaceIndices facingPoints(const TrainedModel& model, const Pose& T_camera_object, std::size_t max_points);

/// Points of a part's surface that poses are tested with: metres, part frame, one plane per coordinate.
struct TestPoints
{
  std::vector<float> x, y, z;
  std::vector<float> nx, ny, nz;
  std::vector<std::uint8_t> near_crease;  ///< TrainedModel::near_crease

  std::size_t size() const { return x.size(); }
};

TestPoints testPoints(const TrainedModel& model, const SurfaceIndices& indices);

/// facingPoints() of many poses: chosen once for each view. The model must outlive it.
class FacingPoints
{
public:
  FacingPoints(const TrainedModel& model, std::size_t max_points);

  const TestPoints& at(const Pose& T_camera_object) const;

private:
  const TrainedModel& model_;
  std::vector<TestPoints> of_views_;
};

/// Surface points that the camera would see at this pose if nothing but the part were there: a z-buffer of the points
/// themselves. Exact also where the trained views are too far apart (into a bore, along a tube); slower than
/// facingPoints.
SurfaceIndices visiblePoints(const TrainedModel& model, const Pose& T_camera_object);

/// Every step-th point so that at most max_points remain.
SurfaceIndices thinned(const SurfaceIndices& points, std::size_t max_points);

/// \param points of the part that face the camera (visiblePoints, facingPoints)
/// \param tolerance of the distance to the surface, metres
/// \param grid what belongs to parts; \param surroundings the same grid with the bin and its floor, which are no
/// evidence for
///   a part but may contradict it
PoseEvidence gatherEvidence(const TestPoints& points, const Pose& T_camera_object, const DepthGrid& grid,
                            const DepthGrid& surroundings, const std::vector<Eigen::Vector3f>& normals,
                            double tolerance, const VerificationParameters& parameters);

/// What the scene does just outside of the part's outline, point by point along it.
struct OutlineEvidence
{
  int ends = 0;       ///< the scene drops behind the part: an edge, as there should be
  int continues = 0;  ///< the surface goes on: the part is not there, or it touches a neighbour of equal height
  int hidden = 0;     ///< something nearer, or no data: speaks neither for nor against

  /// Drawn to 2/3, as if three points had been seen, so that an outline in shadow all around decides nothing.
  double share() const { return (ends + 2.0) / (ends + continues + 3.0); }
};

/// A pose on the middle of a larger surface explains all its points; only the outline tells that it is wrong.
/// \param visible all points that the camera sees (visiblePoints); their spacing must be well below `step`
/// \param step how far outside of the outline the scene is looked at, metres
/// \param tolerance depth difference that is still "going on", metres
OutlineEvidence gatherOutlineEvidence(const TrainedModel& model, const SurfaceIndices& visible,
                                      const Pose& T_camera_object, const DepthGrid& grid, double step,
                                      double tolerance);

/// What was measured in front of the part and carries on the surface that the part explains, as a share of what it
/// explains. Another body that hides the part has a surface of its own: where the explained surface itself goes
/// straight on, past the rim of a bore or where the part bends away, it is that of another part. Beside the part, where
/// nothing of it lies behind, the outline tells.
/// \param visible points that the camera would see (visiblePoints), each weighted by its share of the picture
/// \param grid what belongs to parts; \param normals of that grid
/// \param tolerance of the distance to the surface, metres
double continuedShare(const TrainedModel& model, const SurfaceIndices& visible, const Pose& T_camera_object,
                      const DepthGrid& grid, const std::vector<Eigen::Vector3f>& normals, double tolerance);

/// Image cells that a pose covers with explained pixels, ascending; two poses on one part share most of them.
/// \param scale raw pixels per pixel of this grid, so that poses found on different reductions can be compared
/// \param cell edge of a cell in raw pixels; wider than the spacing of the points that were tested
std::vector<int> coveredCells(const std::vector<int>& pixels, int grid_width, int scale, int cell);

/// How deep a pose reaches through the bin's floor or, below the rim, through its walls, metres; 0 if it does not.
double binPenetration(const OrientedPoints& surface, const Pose& T_camera_object, const Bin& bin);

/// Equation 9: the share of `object_points` that have a model point within `distance`. 0 for no points.
double matchingRate(const KdTree& model_surface, const Pose& T_camera_object,
                    const std::vector<Eigen::Vector3f>& object_points, double distance);

/// The same with the surface itself in place of its points, in a fraction of the time.
/// \param distance below the field's band
double matchingRate(const DistanceField& surface, const Pose& T_camera_object,
                    const std::vector<Eigen::Vector3f>& object_points, double distance);
}  // namespace bin_picking
