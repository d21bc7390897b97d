// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "bin_picking_perception/refinement/verification.hpp"
#include "pixel_window.hpp"

namespace bin_picking
{
namespace
{
constexpr std::size_t MAX_PIXELS = 8000;
constexpr double REACH = 0.65;      // of the diameter, round the part's middle
constexpr double STEP_BEYOND = 1;   // leaves in the picture: farther off, another part may lie alike by chance
constexpr float FARTHEST = 1.5f;    // leaves in space: beyond, it is not beside it
constexpr float MIN_DROP = 2;       // leaves: a lower step is one that a pose which is a little off has moved
constexpr float SAME_SIDE = 0.76f;  // cosine of 40 degrees: the other side of a thin wall has the opposite normal
constexpr float PARALLEL = 0.9f;    // cosine of 26 degrees: straight on, not round a crease

/// A measured point in the part's frame.
struct Measured
{
  enum class Place
  {
    Elsewhere,  ///< not measured, inside of the part, or too far from it
    OnSurface,  ///< the part explains it
    Outside
  };

  Place place = Place::Elsewhere;
  Eigen::Vector3f point;
  Eigen::Vector3f normal;          ///< as measured
  Eigen::Vector3f surface_point;   ///< of the part, next to it, where it lies on the surface
  Eigen::Vector3f surface_normal;  ///< there
};

/// What was measured around a pose, pixel by pixel.
class MeasuredSurface
{
public:
  MeasuredSurface(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid,
                  const std::vector<Eigen::Vector3f>& normals, double tolerance)
      : model_(model),
        leaf_(static_cast<float>(model.parameters.leaf)),
        tolerance_(static_cast<float>(tolerance)),
        T_object_camera_(T_camera_object.inverse().cast<float>())
  {
    const Eigen::Vector3d center = T_camera_object * model.center;
    const PixelWindow window(grid, center, REACH * model.diameter, MAX_PIXELS);
    pixels_.reserve(MAX_PIXELS);
    for (int v = window.v_begin; v < window.v_end; v += window.step, ++height_)
      for (int u = window.u_begin; u < window.u_end; u += window.step)
        pixels_.push_back(place(grid, normals, grid.index(u, v)));
    width_ = height_ > 0 ? static_cast<int>(pixels_.size()) / height_ : 0;
    if (height_ > 0)
      around_ = std::max(
          1, static_cast<int>(std::lround(STEP_BEYOND * model.parameters.leaf / grid.pitch(center.z()) / window.step)));
  }

  double shareContinued() const
  {
    int on_surface = 0;
    int continued = 0;
    for (int v = 0; v < height_; ++v)
      for (int u = 0; u < width_; ++u)
      {
        const Measured& here = at(u, v);
        on_surface += here.place == Measured::Place::OnSurface;
        continued += here.place == Measured::Place::Outside && continuesTheSurface(u, v) && hidesThePart(here.point);
      }
    return on_surface > 0 ? static_cast<double>(continued) / on_surface : 0;
  }

private:
  const Measured& at(int u, int v) const { return pixels_[static_cast<std::size_t>(v * width_ + u)]; }

  Measured place(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& normals, int pixel) const
  {
    Measured measured;
    const Eigen::Vector3f& normal = normals[static_cast<std::size_t>(pixel)];
    if (!grid.valid(pixel) || std::isnan(normal.x()))
      return measured;
    measured.point = T_object_camera_ * grid.point(pixel);
    const DistanceField::Sample sample = model_.field.sample(measured.point);
    if (sample.distance >= model_.field.band())
      return measured;
    measured.normal = T_object_camera_.linear() * normal;
    if (std::abs(sample.distance) < tolerance_)
    {
      measured.surface_normal = sample.gradient.normalized();
      measured.surface_point = measured.point - sample.distance * measured.surface_normal;
      if (measured.normal.dot(measured.surface_normal) > SAME_SIDE)
        measured.place = Measured::Place::OnSurface;
    }
    else if (sample.distance > 0)
      measured.place = Measured::Place::Outside;
    return measured;
  }

  /// Lies in the plane that touches the part at a point that is measured beside it.
  bool continuesTheSurface(int u, int v) const
  {
    const Measured& here = at(u, v);
    for (int y = std::max(0, v - around_); y <= std::min(height_ - 1, v + around_); ++y)
      for (int x = std::max(0, u - around_); x <= std::min(width_ - 1, u + around_); ++x)
      {
        const Measured& beside = at(x, y);
        if (beside.place != Measured::Place::OnSurface)
          continue;
        const Eigen::Vector3f d = here.point - beside.surface_point;
        if (std::abs(beside.surface_normal.dot(d)) < tolerance_ && here.normal.dot(beside.surface_normal) > PARALLEL &&
            d.squaredNorm() < FARTHEST * FARTHEST * leaf_ * leaf_)
          return true;
      }
    return false;
  }

  /// The ray would go on to meet the part's surface well behind the point.
  bool hidesThePart(const Eigen::Vector3f& point) const
  {
    const Eigen::Vector3f ray = (point - T_object_camera_.translation()).normalized();
    const float touching = 0.05f * leaf_;
    float ahead = tolerance_;
    while (ahead < static_cast<float>(model_.diameter))
    {
      const DistanceField::Sample sample = model_.field.sample(point + ahead * ray);
      if (sample.distance < touching)
        return -sample.gradient.normalized().dot(ray) * ahead > MIN_DROP * leaf_;
      ahead += sample.distance;  // nothing of the part is nearer
    }
    return false;
  }

  const TrainedModel& model_;
  float leaf_;
  float tolerance_;
  Eigen::Isometry3f T_object_camera_;
  std::vector<Measured> pixels_;
  int width_ = 0;
  int height_ = 0;
  int around_ = 1;  ///< pixels that are "beside" one, to every side
};
}  // namespace

double continuedShare(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid,
                      const std::vector<Eigen::Vector3f>& normals, double tolerance)
{
  return MeasuredSurface(model, T_camera_object, grid, normals, tolerance).shareContinued();
}
}  // namespace bin_picking
