// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "pixel_random.hpp"
#include "sensor_effects.hpp"

namespace bin_picking::simulation
{
namespace
{
/// A point is lifted off its surface by this share of its distance before it asks for light: single precision leaves
/// errors of a tenth of that.
constexpr double LIFT = 1e-5;

struct Eyes
{
  Eigen::Vector3d second;  ///< projector or second camera
  Eigen::Vector3d light;
};

/// Active stereo throws its pattern from between the cameras.
Eyes eyesOf(const SensorParameters& parameters)
{
  const Eigen::Vector3d second(parameters.baseline, 0, 0);
  return {second, parameters.type == SensorClass::Stereo ? 0.5 * second : second};
}

bool inSecondField(const Eigen::Vector3d& point, const SensorParameters& parameters)
{
  const double shift = parameters.convergence > 0 ? parameters.baseline / parameters.convergence : 0;
  const double across = (point.x() - parameters.baseline) / point.z() + shift;
  const double reach = std::tan(0.5 * parameters.second_field_of_view);
  return std::abs(across) <= reach && std::abs(point.y() / point.z()) <= reach * parameters.height / parameters.width;
}

class Illumination
{
public:
  Illumination(const RayScene& scene, const EffectContext& context)
      : scene_(scene),
        view_(context.view),
        parameters_(context.parameters),
        eyes_(eyesOf(context.parameters)),
        min_cosine_(std::cos(context.parameters.light.max_incidence)),
        widest_spread_(std::exp(PixelRandom::MAX_NORMAL * context.parameters.light.loss_spread)),
        signal_(context.seed, static_cast<std::uint32_t>(RandomStream::Signal)),
        highlight_(context.seed, static_cast<std::uint32_t>(RandomStream::Highlight)),
        incidence_(context.seed, static_cast<std::uint32_t>(RandomStream::Incidence))
  {}

  /// Whether the pixel, which sees a surface, is measured.
  bool received(int u, int v) const
  {
    const Eigen::Vector3d point = view_.point(u, v);
    const Eigen::Vector3d normal = view_.normals[view_.index(u, v)].cast<double>();
    if (parameters_.light.min_signal > 0 && !brightEnough(point, normal, u, v))
      return false;
    if (!steepEnough(normal.dot(-point.normalized()), u, v))
      return false;
    if (parameters_.light.shininess > 0 && saturated(point, normal, u, v))
      return false;
    return parameters_.baseline == 0 || seenBySecondEye(point, normal, u, v);
  }

private:
  /// Whether a value beats its limit, which differs from pixel to pixel by a log-normal factor: what returns ten times
  /// the light that is needed is never lost by it.
  bool beats(double limit, double value, const PixelRandom& random, int u, int v) const
  {
    const double spread = parameters_.light.loss_spread;
    if (spread == 0 || value >= limit * widest_spread_)
      return value >= limit;
    return value * std::exp(spread * random.normal(u, v)) >= limit;
  }

  bool brightEnough(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, int u, int v) const
  {
    const Eigen::Vector3d to_light = eyes_.light - point;
    const double cosine = normal.dot(to_light.normalized());
    const double nearness = parameters_.reference_distance * parameters_.reference_distance / to_light.squaredNorm();
    const double signal = parameters_.light.albedo * cosine * nearness;
    return beats(parameters_.light.min_signal, signal, signal_, u, v);
  }

  bool steepEnough(double cosine, int u, int v) const { return beats(min_cosine_, cosine, incidence_, u, v); }

  /// Where the normal halves the angle between the light and an eye, a smooth surface mirrors the one into the other.
  /// The lobe is that of Trowbridge and Reitz (GGX).
  bool saturated(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, int u, int v) const
  {
    const Eigen::Vector3d to_light = (eyes_.light - point).normalized();
    const auto lobe = [&](const Eigen::Vector3d& eye) {
      const double cosine = normal.dot((to_light + (eye - point).normalized()).normalized());
      const double square = std::max(cosine * cosine, 1e-12);
      const double width = parameters_.light.highlight_width;
      const double steepness = (1 - square) / (square * width * width);  // (tan / width)^2
      return 1 / ((1 + steepness) * (1 + steepness));
    };
    double strongest = lobe(Eigen::Vector3d::Zero());
    if (parameters_.type == SensorClass::Stereo)
      strongest = std::max(strongest, lobe(eyes_.second));
    return highlight_.uniform(u, v) < parameters_.light.shininess * strongest;
  }

  bool seenBySecondEye(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, int u, int v) const
  {
    const Eigen::Vector3d to_eye = eyes_.second - point;
    const double cosine = normal.dot(to_eye.normalized());
    if (cosine <= 0 || !steepEnough(cosine, u, v) || !inSecondField(point, parameters_))
      return false;
    return scene_.unobstructed(point + LIFT * point.norm() * normal, eyes_.second);
  }

  const RayScene& scene_;
  const SensorView& view_;
  const SensorParameters& parameters_;
  Eyes eyes_;
  double min_cosine_;
  double widest_spread_;
  PixelRandom signal_;
  PixelRandom highlight_;
  PixelRandom incidence_;
};
}  // namespace

Exposure expose(const RayScene& scene, const EffectContext& context)
{
  const SensorView& view = context.view;
  const Illumination illumination(scene, context);
  Exposure exposure;
  exposure.depth = view.depth;
  exposure.received.assign(view.size(), 0);
  context.executor.forEach(static_cast<std::size_t>(view.height), [&](std::size_t row) {
    const FlushDenormals flush;
    const int v = static_cast<int>(row);
    for (int u = 0; u < view.width; ++u)
      if (view.labels[view.index(u, v)] >= 0)
        exposure.received[view.index(u, v)] = illumination.received(u, v) ? 1 : 0;
  });
  return exposure;
}
}  // namespace bin_picking::simulation
