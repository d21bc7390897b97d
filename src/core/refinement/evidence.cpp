// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "../common/simd.hpp"
#include "bin_picking_perception/refinement/verification.hpp"

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

TestPoints testPoints(const TrainedModel& model, const SurfaceIndices& indices)
{
  TestPoints points;
  for (auto* plane : {&points.x, &points.y, &points.z, &points.nx, &points.ny, &points.nz})
    plane->reserve(indices.size());
  points.near_crease.reserve(indices.size());
  for (const std::uint32_t i : indices)
  {
    const Eigen::Vector3f& p = model.surface.points[i];
    const Eigen::Vector3f& n = model.surface.normals[i];
    points.x.push_back(p.x());
    points.y.push_back(p.y());
    points.z.push_back(p.z());
    points.nx.push_back(n.x());
    points.ny.push_back(n.y());
    points.nz.push_back(n.z());
    points.near_crease.push_back(model.near_crease[i]);
  }
  return points;
}

namespace
{
constexpr std::size_t CHUNK = 64;  // points that are posed at once

/// How points of the part come to the camera's picture, and how far from their pixels they may be.
struct View
{
  std::array<float, 9> rotation;  ///< row by row
  std::array<float, 3> translation;
  float fx, fy, cx, cy;
  float pitch_per_depth;
  float tolerance;
  float most_residual;  ///< a larger one is no finding; with room for what rounding moves
};

/// Points of the part at a pose, as the camera sees them.
struct PosedPoints
{
  std::array<float, CHUNK> x, y, z;
  std::array<float, CHUNK> nx, ny, nz;
  std::array<float, CHUNK> cosine;         ///< between the normal and the ray to the camera
  std::array<float, CHUNK> u, v;           ///< to be rounded down to pixels
  std::array<float, CHUNK> squared_aside;  ///< from the point, along its plane, to what may be its measurement
  std::array<float, CHUNK> reach;          ///< to what may be a finding at all

  Eigen::Vector3f position(std::size_t k) const { return {x[k], y[k], z[k]}; }
  Eigen::Vector3f normal(std::size_t k) const { return {nx[k], ny[k], nz[k]}; }
};

BIN_PICKING_SIMD void posePoints(const TestPoints& points, std::size_t first, std::size_t count, const View& given,
                                 PosedPoints& posed)
{
  const View view = given;
  const auto& r = view.rotation;
  const auto& t = view.translation;
  const float* x = points.x.data() + first;
  const float* y = points.y.data() + first;
  const float* z = points.z.data() + first;
  const float* nx = points.nx.data() + first;
  const float* ny = points.ny.data() + first;
  const float* nz = points.nz.data() + first;
  for (std::size_t k = 0; k < count; ++k)
  {
    const float px = r[0] * x[k] + r[1] * y[k] + r[2] * z[k] + t[0];
    const float py = r[3] * x[k] + r[4] * y[k] + r[5] * z[k] + t[1];
    const float pz = r[6] * x[k] + r[7] * y[k] + r[8] * z[k] + t[2];
    const float mx = r[0] * nx[k] + r[1] * ny[k] + r[2] * nz[k];
    const float my = r[3] * nx[k] + r[4] * ny[k] + r[5] * nz[k];
    const float mz = r[6] * nx[k] + r[7] * ny[k] + r[8] * nz[k];
    const float cosine = -(mx * px + my * py + mz * pz) / std::sqrt(px * px + py * py + pz * pz);
    // The pixel's footprint on a surface that is seen at a flat angle.
    const float aside = view.tolerance + 1.5f * view.pitch_per_depth * pz / (cosine > 0.2f ? cosine : 0.2f);
    posed.x[k] = px;
    posed.y[k] = py;
    posed.z[k] = pz;
    posed.nx[k] = mx;
    posed.ny[k] = my;
    posed.nz[k] = mz;
    posed.cosine[k] = cosine;
    posed.u[k] = view.fx * px / pz + view.cx + 0.5f;
    posed.v[k] = view.fy * py / pz + view.cy + 0.5f;
    posed.squared_aside[k] = aside * aside;
    posed.reach[k] = std::sqrt(aside * aside + view.most_residual * view.most_residual);
  }
}

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

/// Holds posed points against the grid.
class PointTest
{
public:
  PointTest(const PosedPoints& points, const DepthGrid& grid, const DepthGrid& surroundings,
            const std::vector<Eigen::Vector3f>& normals, const View& view, const VerificationParameters& parameters)
      : points_(points),
        grid_(grid),
        surroundings_(surroundings),
        normals_(normals),
        pitch_per_depth_(view.pitch_per_depth),
        tolerance_(view.tolerance),
        match_distance_(static_cast<float>(parameters.match_distance)),
        min_cosine_(static_cast<float>(std::cos(parameters.max_normal_angle)))
  {}

  /// The points' pixels lie scattered in memory and are fetched ahead of their use.
  void prefetch(std::size_t count) const
  {
    for (std::size_t k = 0; k < count; ++k)
      if (const int i = pixel(k); i >= 0)
      {
        const auto at = static_cast<std::size_t>(i);
        __builtin_prefetch(&grid_.z[at]);
        __builtin_prefetch(&grid_.x[at]);
        __builtin_prefetch(&grid_.y[at]);
        __builtin_prefetch(&normals_[at]);
      }
  }

  /// \param near_crease the measured normal may be anything between those of two faces
  Finding operator()(std::size_t k, bool near_crease) const
  {
    Finding finding;
    const int center = pixel(k);
    if (center < 0)
      return finding;
    const int column = static_cast<int>(points_.u[k]);
    const int row = static_cast<int>(points_.v[k]);
    // The measured surface may lie half a pixel beside the ray: a neighbour that explains the point is as good.
    constexpr int AROUND[5][2] = {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    for (const auto& offset : AROUND)
      if (grid_.inside(column + offset[0], row + offset[1]) &&
          isWithin(grid_.index(column + offset[0], row + offset[1]), k) &&
          explains(grid_.index(column + offset[0], row + offset[1]), k, near_crease, finding))
        return finding;
    if (surroundings_.valid(center))
      finding.verdict = contradiction(center, k);
    return finding;
  }

private:
  /// That sees the point; -1 if it is outside of the picture.
  int pixel(std::size_t k) const
  {
    const float u = points_.u[k];
    const float v = points_.v[k];
    const bool inside = u >= 0 && v >= 0 && u < static_cast<float>(grid_.width) && v < static_cast<float>(grid_.height);
    return inside ? grid_.index(static_cast<int>(u), static_cast<int>(v)) : -1;
  }

  /// Else the pixel is too far for any finding; false for NaN. By the depth alone, the other planes are not read.
  bool isWithin(int pixel, std::size_t k) const
  {
    return std::abs(grid_.z[static_cast<std::size_t>(pixel)] - points_.z[k]) <= points_.reach[k];
  }

  bool explains(int pixel, std::size_t k, bool near_crease, Finding& finding) const
  {
    const Eigen::Vector3f normal = points_.normal(k);
    const Eigen::Vector3f d = grid_.point(pixel) - points_.position(k);
    const float residual = normal.dot(d);
    const float squared_aside = d.squaredNorm() - residual * residual;
    const bool is_near = squared_aside < points_.squared_aside[k];  // false for NaN: nothing was measured
    finding.matched = finding.matched || (is_near && std::abs(residual) < match_distance_);
    if (!is_near || std::abs(residual) > tolerance_)
      return false;
    if (!near_crease && normals_[static_cast<std::size_t>(pixel)].dot(normal) < min_cosine_)  // false for NaN
      return false;
    finding.verdict = Verdict::Explained;
    finding.pixel = pixel;
    finding.residual = residual;
    return true;
  }

  Verdict contradiction(int pixel, std::size_t k) const
  {
    const float cosine = std::max(0.3f, points_.cosine[k]);
    const float pitch = pitch_per_depth_ * points_.z[k];
    const float limit = tolerance_ / cosine + pitch * std::sqrt(1 - cosine * cosine) / cosine;
    const float ahead = points_.z[k] - surroundings_.z[static_cast<std::size_t>(pixel)];
    if (ahead > limit)
      return Verdict::Occluded;
    if (ahead < -limit)
      return Verdict::Violated;
    return grid_.valid(pixel) ? Verdict::Misfit : Verdict::Unmeasured;  // a part that touches the floor or a wall
  }

  const PosedPoints& points_;
  const DepthGrid& grid_;
  const DepthGrid& surroundings_;
  const std::vector<Eigen::Vector3f>& normals_;
  float pitch_per_depth_;
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
View viewAt(const Pose& T_camera_object, const DepthGrid& grid, double tolerance, double match_distance)
{
  const Eigen::Isometry3f T = T_camera_object.cast<float>();
  View view;
  Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(view.rotation.data()) = T.linear();
  Eigen::Map<Eigen::Vector3f>(view.translation.data()) = T.translation();
  view.fx = static_cast<float>(grid.camera.fx);
  view.fy = static_cast<float>(grid.camera.fy);
  view.cx = static_cast<float>(grid.camera.cx);
  view.cy = static_cast<float>(grid.camera.cy);
  view.pitch_per_depth = static_cast<float>(grid.pitch(1.0));
  view.tolerance = static_cast<float>(tolerance);
  view.most_residual = 1.001f * static_cast<float>(std::max(tolerance, match_distance));
  return view;
}
}  // namespace

PoseEvidence gatherEvidence(const TestPoints& points, const Pose& T_camera_object, const DepthGrid& grid,
                            const DepthGrid& surroundings, const std::vector<Eigen::Vector3f>& normals,
                            double tolerance, const VerificationParameters& parameters)
{
  const View view = viewAt(T_camera_object, grid, tolerance, parameters.match_distance);
  PosedPoints posed;
  const PointTest test(posed, grid, surroundings, normals, view, parameters);
  PoseEvidence evidence;
  evidence.pixels.reserve(points.size());
  for (std::size_t first = 0; first < points.size(); first += CHUNK)
  {
    const std::size_t size = std::min(CHUNK, points.size() - first);
    posePoints(points, first, size, view, posed);
    test.prefetch(size);
    for (std::size_t k = 0; k < size; ++k)
    {
      if (!(posed.z[k] > 0 && posed.cosine[k] > 0))
        continue;  // just beyond the silhouette at this pose
      const auto weight = static_cast<double>(posed.cosine[k]);
      evidence.facing += weight;
      count(test(k, points.near_crease[first + k] != 0), weight, evidence);
    }
  }
  evidence.rms =
      evidence.explained > 0 ? std::sqrt(evidence.rms / evidence.explained) : std::numeric_limits<double>::quiet_NaN();
  return evidence;
}
}  // namespace bin_picking
