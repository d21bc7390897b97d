// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/refinement/verification.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bin_picking_perception/common/kd_tree.hpp"

namespace bin_picking
{
double PoseEvidence::inlierShare(double unmeasured_weight) const
{
  const double all = explained + misfit + violated + unmeasured_weight * unmeasured;
  return all > 0 ? explained / all : 0;
}

double PoseEvidence::violationShare() const
{
  const double measured = explained + misfit + violated;
  return measured > 0 ? violated / measured : 1;
}

double PoseEvidence::matchingRate() const
{
  const double object_points = explained + misfit + violated;
  return object_points > 0 ? matched / object_points : 0;
}

const ViewTemplate& nearestView(const TrainedModel& model, const Pose& T_camera_object)
{
  const Eigen::Vector3f direction = (T_camera_object.inverse().translation() - model.center).normalized().cast<float>();
  const ViewTemplate* nearest = &model.views.front();
  float best = -2;
  for (const ViewTemplate& view : model.views)
    if (const float cosine = view.direction.dot(direction); cosine > best)
    {
      best = cosine;
      nearest = &view;
    }
  return *nearest;
}

FacingPoints::FacingPoints(const TrainedModel& model, std::size_t max_points) : model_(model)
{
  for (const ViewTemplate& view : model.views)
    of_views_.push_back(thinned(view.visible, max_points));
}

const SurfaceIndices& FacingPoints::at(const Pose& T_camera_object) const
{
  return of_views_[static_cast<std::size_t>(&nearestView(model_, T_camera_object) - model_.views.data())];
}

SurfaceIndices facingPoints(const TrainedModel& model, const Pose& T_camera_object, std::size_t max_points)
{
  return thinned(nearestView(model, T_camera_object).visible, max_points);
}

namespace
{
enum class Verdict
{
  Explained,
  Misfit,
  Occluded,
  Violated,
  Unmeasured
};

struct Finding
{
  Verdict verdict = Verdict::Unmeasured;
  int pixel = -1;
  float residual = 0;
  bool matched = false;
};

/// A point of the part at a pose, as the camera sees it.
struct PosedPoint
{
  Eigen::Vector3f position;
  Eigen::Vector3f normal;
  float cosine;  ///< between the normal and the ray to the camera
  bool crease;   ///< the measured normal may be anything between those of two faces
};

class PointTest
{
public:
  PointTest(const DepthGrid& grid, const DepthGrid& surroundings, const std::vector<Eigen::Vector3f>& normals,
            double tolerance, const VerificationParameters& parameters)
      : grid_(grid),
        surroundings_(surroundings),
        normals_(normals),
        focal_(static_cast<float>(grid.camera.fx), static_cast<float>(grid.camera.fy)),
        middle_(static_cast<float>(grid.camera.cx), static_cast<float>(grid.camera.cy)),
        pitch_per_depth_(static_cast<float>(grid.pitch(1.0))),
        tolerance_(static_cast<float>(tolerance)),
        match_distance_(static_cast<float>(parameters.match_distance)),
        most_residual_(1.001f * std::max(tolerance_, match_distance_)),
        min_cosine_(static_cast<float>(std::cos(parameters.max_normal_angle)))
  {}

  Finding operator()(const PosedPoint& point) const
  {
    const float inverse_z = 1 / point.position.z();
    const float u = focal_.x() * point.position.x() * inverse_z + middle_.x() + 0.5f;
    const float v = focal_.y() * point.position.y() * inverse_z + middle_.y() + 0.5f;
    Finding finding;
    if (!(u >= 0 && v >= 0 && u < static_cast<float>(grid_.width) && v < static_cast<float>(grid_.height)))
      return finding;
    const int column = static_cast<int>(u);
    const int row = static_cast<int>(v);
    const float pitch = pitch_per_depth_ * point.position.z();
    // The pixel's footprint on a surface that is seen at a flat angle.
    const float aside = tolerance_ + 1.5f * pitch / std::max(0.2f, point.cosine);
    const float reach = std::sqrt(aside * aside + most_residual_ * most_residual_);
    // The measured surface may lie half a pixel beside the ray: a neighbour that explains the point is as good.
    constexpr int AROUND[5][2] = {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    for (const auto& offset : AROUND)
      if (grid_.inside(column + offset[0], row + offset[1]) &&
          isWithin(grid_.index(column + offset[0], row + offset[1]), point, reach) &&
          explains(grid_.index(column + offset[0], row + offset[1]), point, aside * aside, finding))
        return finding;
    const int center = grid_.index(column, row);
    if (surroundings_.valid(center))
      finding.verdict = contradiction(center, point, pitch);
    return finding;
  }

private:
  /// Else the pixel is too far for any finding; false for NaN. By the depth alone, the other planes are not read.
  bool isWithin(int pixel, const PosedPoint& point, float reach) const
  {
    return std::abs(grid_.z[static_cast<std::size_t>(pixel)] - point.position.z()) <= reach;
  }

  bool explains(int pixel, const PosedPoint& point, float max_squared_aside, Finding& finding) const
  {
    const Eigen::Vector3f d = grid_.point(pixel) - point.position;
    const float residual = point.normal.dot(d);
    const float squared_aside = d.squaredNorm() - residual * residual;
    const bool is_near = squared_aside < max_squared_aside;  // false for NaN: nothing was measured
    finding.matched = finding.matched || (is_near && std::abs(residual) < match_distance_);
    if (!is_near || std::abs(residual) > tolerance_)
      return false;
    if (!point.crease && normals_[static_cast<std::size_t>(pixel)].dot(point.normal) < min_cosine_)  // false for NaN
      return false;
    finding.verdict = Verdict::Explained;
    finding.pixel = pixel;
    finding.residual = residual;
    return true;
  }

  Verdict contradiction(int pixel, const PosedPoint& point, float pitch) const
  {
    const float cosine = std::max(0.3f, point.cosine);
    const float limit = tolerance_ / cosine + pitch * std::sqrt(1 - cosine * cosine) / cosine;
    const float ahead = point.position.z() - surroundings_.z[static_cast<std::size_t>(pixel)];
    if (ahead > limit)
      return Verdict::Occluded;
    if (ahead < -limit)
      return Verdict::Violated;
    return grid_.valid(pixel) ? Verdict::Misfit : Verdict::Unmeasured;  // a part that touches the floor or a wall
  }

  const DepthGrid& grid_;
  const DepthGrid& surroundings_;
  const std::vector<Eigen::Vector3f>& normals_;
  Eigen::Vector2f focal_;
  Eigen::Vector2f middle_;
  float pitch_per_depth_;
  float tolerance_;
  float match_distance_;
  float most_residual_;  ///< a larger one is no finding; with room for what rounding moves
  float min_cosine_;
};

void count(const Finding& finding, double weight, PoseEvidence& evidence)
{
  switch (finding.verdict)
  {
    case Verdict::Explained:
      evidence.explained += weight;
      evidence.pixels.push_back(finding.pixel);
      evidence.rms += weight * static_cast<double>(finding.residual * finding.residual);
      break;
    case Verdict::Misfit:
      evidence.misfit += weight;
      break;
    case Verdict::Occluded:
      evidence.occluded += weight;
      break;
    case Verdict::Violated:
      evidence.violated += weight;
      break;
    case Verdict::Unmeasured:
      evidence.unmeasured += weight;
      break;
  }
  const bool object_point = finding.verdict != Verdict::Occluded && finding.verdict != Verdict::Unmeasured;
  evidence.matched += object_point && finding.matched ? weight : 0;
}
}  // namespace

PoseEvidence gatherEvidence(const TrainedModel& model, const SurfaceIndices& facing, const Pose& T_camera_object,
                            const DepthGrid& grid, const DepthGrid& surroundings,
                            const std::vector<Eigen::Vector3f>& normals, double tolerance,
                            const VerificationParameters& parameters)
{
  const Eigen::Isometry3f T = T_camera_object.cast<float>();
  const PointTest test(grid, surroundings, normals, tolerance, parameters);
  PoseEvidence evidence;
  evidence.pixels.reserve(facing.size());
  for (const std::uint32_t i : facing)
  {
    PosedPoint point{T * model.surface.points[i], T.linear() * model.surface.normals[i], 0, model.near_crease[i] != 0};
    point.cosine = -point.normal.dot(point.position) / point.position.norm();
    if (point.position.z() <= 0 || point.cosine <= 0)
      continue;  // just beyond the silhouette at this pose
    const auto weight = static_cast<double>(point.cosine);
    evidence.facing += weight;
    count(test(point), weight, evidence);
  }
  evidence.rms =
      evidence.explained > 0 ? std::sqrt(evidence.rms / evidence.explained) : std::numeric_limits<double>::quiet_NaN();
  return evidence;
}

double binPenetration(const OrientedPoints& surface, const Pose& T_camera_object, const Bin& bin)
{
  const Eigen::Isometry3f T_bin_object = (bin.T_camera_bin.inverse() * T_camera_object).cast<float>();
  const Eigen::Array3f size = bin.inner_size.cast<float>();
  float deepest = 0;
  for (const Eigen::Vector3f& point : surface.points)
  {
    const Eigen::Vector3f p = T_bin_object * point;
    deepest = std::max(deepest, -p.z());
    // What is outside of a wall but higher than its rim leans over it; what is just below may have come over it too.
    const float through_wall = (p.head<2>().array().abs() - 0.5f * size.head<2>()).maxCoeff();
    deepest = std::max(deepest, std::min(through_wall, size.z() - p.z()));
  }
  return static_cast<double>(deepest);
}

double matchingRate(const KdTree& model_surface, const Pose& T_camera_object,
                    const std::vector<Eigen::Vector3f>& object_points, double distance)
{
  if (object_points.empty())
    return 0;
  const Eigen::Isometry3f T_object_camera = T_camera_object.inverse().cast<float>();
  std::size_t matched = 0;
  for (const auto& point : object_points)
    matched += model_surface.nearest(T_object_camera * point, static_cast<float>(distance)).index >= 0;
  return static_cast<double>(matched) / static_cast<double>(object_points.size());
}
}  // namespace bin_picking
