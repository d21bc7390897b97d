// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/refinement/verification.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bin_picking_perception/common/kd_tree.hpp"

namespace bin_picking
{
void VerificationParameters::visit(ParameterVisitor& v)
{
  v.field({"enabled", "", "test poses against the depth grid; false: only the matching rate decides (the paper)"},
          enabled);
  v.field({"match_distance", "m", "distance threshold of the matching rate (Equation 9)", 1e-4, 0.1}, match_distance);
  v.field({"min_matching_rate", "", "smallest accepted matching rate", 0, 1}, min_matching_rate);
  v.field({"depth_tolerance", "", "distance to the surface that still explains a point, in leaves, noise not counted",
           0.0, 5},
          depth_tolerance);
  v.field({"noise_tolerance", "", "what is added to it, in standard deviations of the measured noise", 0, 20},
          noise_tolerance);
  v.field({"max_normal_angle", "rad", "a point whose normal is turned by more is not explained", 0.05, 3.2},
          max_normal_angle);
  v.field({"min_visible_fraction", "",
           "smallest explained share of the surface that faces the camera; less accepts parts "
           "that are hidden more",
           0, 1},
          min_visible_fraction);
  v.field(
      {"min_inlier_share", "", "smallest share of explained points among those that speak for or against a pose", 0, 1},
      min_inlier_share);
  v.field({"max_violation_share", "", "largest share of points behind which the sensor saw something", 0, 1},
          max_violation_share);
  v.field({"min_outline_share", "",
           "smallest share of the outline at which the scene ends, as it must around a part that lies "
           "free; parts packed side by side at one height need less",
           0, 1},
          min_outline_share);
  v.field(
      {"min_score", "", "smallest accepted probability that a pose is right; more returns fewer and surer ones", 0, 1},
      min_score);
  v.field({"unmeasured_weight", "",
           "how much a point without data speaks against a pose, compared to a contradicted one", 0, 1},
          unmeasured_weight);
  v.field({"min_turn_margin", "",
           "a pose is ambiguous if another one, turned so that most of the part looks the same, is "
           "contradicted by less than this more, in squares of a leaf's edge; 0 accepts guesses",
           0, 1000},
          min_turn_margin);
  v.field({"min_surface_share", "",
           "smallest share of the points measured near the part's surface that lie on it; parts of "
           "another shape leave points beside it",
           0, 1},
          min_surface_share);
  v.field({"max_bin_penetration", "m",
           "how deep a pose may reach through the floor or a wall of the given bin; as much as the "
           "bin's pose may be wrong",
           0, 1},
          max_bin_penetration);
  v.field(
      {"overlap", "", "a detection that shares more than this part of its pixels with better ones is dropped", 0.01, 1},
      overlap);
  v.field({"max_refined", "", "clusters that are refined and tested in full, best first", 1, 10000}, max_refined);
}

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

class PointTest
{
public:
  PointTest(const DepthGrid& grid, const DepthGrid& surroundings, const std::vector<Eigen::Vector3f>& normals,
            double tolerance, const VerificationParameters& parameters)
      : grid_(grid),
        surroundings_(surroundings),
        normals_(normals),
        tolerance_(static_cast<float>(tolerance)),
        match_distance_(static_cast<float>(parameters.match_distance)),
        min_cosine_(static_cast<float>(std::cos(parameters.max_normal_angle)))
  {}

  /// \param crease the measured normal may be anything between those of two faces
  Finding operator()(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, bool crease) const
  {
    const auto& camera = grid_.camera;
    const auto u = static_cast<int>(std::lround(camera.fx * static_cast<double>(point.x() / point.z()) + camera.cx));
    const auto v = static_cast<int>(std::lround(camera.fy * static_cast<double>(point.y() / point.z()) + camera.cy));
    Finding finding;
    if (!grid_.inside(u, v))
      return finding;
    const int center = grid_.index(u, v);
    // The measured surface may lie half a pixel beside the ray: a neighbour that explains the point is as good.
    constexpr int AROUND[5][2] = {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    for (const auto& offset : AROUND)
      if (grid_.inside(u + offset[0], v + offset[1]) &&
          explains(grid_.index(u + offset[0], v + offset[1]), point, normal, crease, finding))
        return finding;
    if (surroundings_.valid(center))
      finding.verdict = contradiction(center, point, normal);
    return finding;
  }

private:
  bool explains(int pixel, const Eigen::Vector3f& point, const Eigen::Vector3f& normal, bool crease,
                Finding& finding) const
  {
    if (!grid_.valid(pixel))
      return false;
    const Eigen::Vector3f d = grid_.point(pixel) - point;
    const auto pitch = static_cast<float>(grid_.pitch(static_cast<double>(point.z())));
    const float residual = normal.dot(d);
    const float aside = (d - residual * normal).norm();
    // The pixel's footprint on a surface that is seen at a flat angle.
    const float cosine = std::max(0.2f, -normal.dot(point) / point.norm());
    const bool is_near = aside < tolerance_ + 1.5f * pitch / cosine;
    finding.matched = finding.matched || (is_near && std::abs(residual) < match_distance_);
    if (!is_near || std::abs(residual) > tolerance_)
      return false;
    const Eigen::Vector3f& measured = normals_[static_cast<std::size_t>(pixel)];
    if (!crease && !std::isnan(measured.x()) && measured.dot(normal) < min_cosine_)
      return false;
    finding.verdict = Verdict::Explained;
    finding.pixel = pixel;
    finding.residual = residual;
    return true;
  }

  Verdict contradiction(int pixel, const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const
  {
    const auto pitch = static_cast<float>(grid_.pitch(static_cast<double>(point.z())));
    const float cosine = std::max(0.3f, -normal.dot(point) / point.norm());
    const float limit = tolerance_ / cosine + pitch * std::sqrt(1 - cosine * cosine) / cosine;
    const float ahead = point.z() - surroundings_.z[static_cast<std::size_t>(pixel)];
    if (ahead > limit)
      return Verdict::Occluded;
    if (ahead < -limit)
      return Verdict::Violated;
    return grid_.valid(pixel) ? Verdict::Misfit : Verdict::Unmeasured;  // a part that touches the floor or a wall
  }

  const DepthGrid& grid_;
  const DepthGrid& surroundings_;
  const std::vector<Eigen::Vector3f>& normals_;
  float tolerance_;
  float match_distance_;
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
  for (const std::uint32_t i : facing)
  {
    const Eigen::Vector3f point = T * model.surface.points[i];
    const Eigen::Vector3f normal = T.linear() * model.surface.normals[i];
    const float cosine = -normal.dot(point) / point.norm();
    if (point.z() <= 0 || cosine <= 0)
      continue;  // just beyond the silhouette at this pose
    const auto weight = static_cast<double>(cosine);
    evidence.facing += weight;
    count(test(point, normal, model.near_crease[i] != 0), weight, evidence);
  }
  evidence.rms =
      evidence.explained > 0 ? std::sqrt(evidence.rms / evidence.explained) : std::numeric_limits<double>::quiet_NaN();
  std::sort(evidence.pixels.begin(), evidence.pixels.end());
  evidence.pixels.erase(std::unique(evidence.pixels.begin(), evidence.pixels.end()), evidence.pixels.end());
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

double matchingRate(const OrientedPoints& model_surface, const Pose& T_camera_object,
                    const std::vector<Eigen::Vector3f>& object_points, double distance)
{
  if (object_points.empty())
    return 0;
  const KdTree tree(model_surface.points);
  const Eigen::Isometry3f T_object_camera = T_camera_object.inverse().cast<float>();
  std::size_t matched = 0;
  for (const auto& point : object_points)
    matched += tree.nearest(T_object_camera * point, static_cast<float>(distance)).index >= 0;
  return static_cast<double>(matched) / static_cast<double>(object_points.size());
}
}  // namespace bin_picking
