// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "structured_light.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "random.hpp"

namespace bin_picking::simulation
{
namespace
{
constexpr double NOISE_DISTANCE = 0.8;      // metres at which depth_noise holds
constexpr double SHADOW_TOLERANCE = 0.001;  // metres: surfaces do not shade themselves
constexpr float NEIGHBOUR_WEIGHT = 0.25f;   // of the noise of the next pixel, per axis

/// Lines of `count` values, `step` apart, blurred by [w 1 w] and scaled back to variance 1; the ends meet.
std::vector<float> blurred(const std::vector<float>& in, int count, int step)
{
  const float scale = 1 / std::sqrt(1 + 2 * NEIGHBOUR_WEIGHT * NEIGHBOUR_WEIGHT);
  std::vector<float> out(in.size());
  for (std::size_t i = 0; i < in.size(); ++i)
  {
    const int position = static_cast<int>(i) / step % count;
    const std::size_t before = position > 0 ? i - step : i + static_cast<std::size_t>(step) * (count - 1);
    const std::size_t after = position + 1 < count ? i + step : i - static_cast<std::size_t>(step) * (count - 1);
    out[i] = scale * (in[i] + NEIGHBOUR_WEIGHT * (in[before] + in[after]));
  }
  return out;
}

std::vector<float> correlatedNoise(int width, int height, std::uint32_t seed)
{
  Random random(seed);
  std::vector<float> white(static_cast<std::size_t>(width) * height);
  for (float& value : white)
    value = static_cast<float>(random.normal());
  return blurred(blurred(white, width, 1), height, width);
}

/// The neighbour on the same object that is nearer in depth, of the two along one axis; -1: none.
int smootherNeighbour(const DepthRenderer& view, int u, int v, int du, int dv)
{
  const auto index = [&](int a, int b) { return b * view.width() + a; };
  const auto k = static_cast<std::size_t>(index(u, v));
  int best = -1;
  float smallest = std::numeric_limits<float>::infinity();
  for (const int sign : {-1, 1})
  {
    const int a = u + sign * du;
    const int b = v + sign * dv;
    if (a < 0 || b < 0 || a >= view.width() || b >= view.height())
      continue;
    const auto n = static_cast<std::size_t>(index(a, b));
    const float step = std::abs(view.depth()[n] - view.depth()[k]);
    if (view.labels()[n] == view.labels()[k] && step < smallest)
    {
      best = static_cast<int>(n);
      smallest = step;
    }
  }
  return best;
}

/// Cosine of the angle between the ray and the surface's normal; 0 where the surface is too small to tell.
double cosineOfIncidence(const DepthRenderer& view, const DepthGrid& ideal, int u, int v)
{
  const int beside = smootherNeighbour(view, u, v, 1, 0);
  const int below = smootherNeighbour(view, u, v, 0, 1);
  if (beside < 0 || below < 0)
    return 0;
  const Eigen::Vector3d p = ideal.point(ideal.index(u, v)).cast<double>();
  const Eigen::Vector3d normal =
      (ideal.point(beside).cast<double>() - p).cross(ideal.point(below).cast<double>() - p).normalized();
  return std::abs(normal.dot(p.normalized()));
}

bool lit(const Eigen::Vector3d& p_projector, const DepthRenderer& projector)
{
  const Eigen::Vector2d pixel = projector.camera().project(p_projector);
  const int u = static_cast<int>(std::lround(pixel.x()));
  const int v = static_cast<int>(std::lround(pixel.y()));
  if (u < 1 || v < 1 || u + 1 >= projector.width() || v + 1 >= projector.height())
    return false;
  float farthest = 0;
  for (int b = v - 1; b <= v + 1; ++b)
    for (int a = u - 1; a <= u + 1; ++a)
      farthest = std::max(farthest,
                          projector.depth()[static_cast<std::size_t>(b) * static_cast<std::size_t>(projector.width()) +
                                            static_cast<std::size_t>(a)]);
  return p_projector.z() <= farthest + SHADOW_TOLERANCE;
}
}  // namespace

PinholeCamera cameraOf(const SensorParameters& parameters)
{
  const double focal = 0.5 * parameters.width / std::tan(0.5 * parameters.field_of_view);
  return {focal, focal, 0.5 * (parameters.width - 1), 0.5 * (parameters.height - 1)};
}

Pose projectorFromCamera(const SensorParameters& parameters)
{
  Pose T_projector_camera = Pose::Identity();
  T_projector_camera.translation().x() = -parameters.baseline;
  return T_projector_camera;
}

DepthRenderer makeProjector(const SensorParameters& parameters)
{
  PinholeCamera camera = cameraOf(parameters);
  const int margin_x = parameters.width / 2;  // near and far of the nominal distance the picture shifts sideways
  const int margin_y = parameters.height / 8;
  camera.cx += margin_x + camera.fx * parameters.baseline / parameters.distance;
  camera.cy += margin_y;
  return DepthRenderer(parameters.width + 2 * margin_x, parameters.height + 2 * margin_y, camera);
}

DepthGrid measure(const DepthRenderer& view, const DepthRenderer& projector, const SensorParameters& parameters)
{
  const DepthGrid ideal = view.grid();
  DepthGrid measured = ideal;
  const Pose T_projector_camera = projectorFromCamera(parameters);
  const std::vector<float> noise =
      correlatedNoise(ideal.width, ideal.height, static_cast<std::uint32_t>(parameters.seed));
  const double smallest_cosine = std::cos(parameters.max_incidence);
  for (int v = 0; v < ideal.height; ++v)
    for (int u = 0; u < ideal.width; ++u)
    {
      const int i = ideal.index(u, v);
      if (!ideal.valid(i))
        continue;
      const Eigen::Vector3d p = ideal.point(i).cast<double>();
      const double cosine = cosineOfIncidence(view, ideal, u, v);
      if (cosine < smallest_cosine || !lit(T_projector_camera * p, projector))
      {
        measured.invalidate(i);
        continue;
      }
      const double sigma = parameters.depth_noise * std::pow(p.z() / NOISE_DISTANCE, 2) / cosine;
      const auto k = static_cast<std::size_t>(i);
      const double stretch = 1 + sigma * static_cast<double>(noise[k]) / p.z();  // along the ray: the pixel stays
      measured.x[k] = static_cast<float>(p.x() * stretch);
      measured.y[k] = static_cast<float>(p.y() * stretch);
      measured.z[k] = static_cast<float>(p.z() * stretch);
    }
  return measured;
}

void SensorParameters::visit(ParameterVisitor& v)
{
  v.field({"width", "", "pixels per row", 64, 4096}, width);
  v.field({"height", "", "pixels per column", 64, 4096}, height);
  v.field({"distance", "m", "from the camera to the middle of the bin's floor", 0.2, 5}, distance);
  v.field({"tilt", "rad", "of the optical axis against the vertical", 0, 0.8}, tilt);
  v.field({"field_of_view", "rad", "angle between the left and the right edge of the picture", 0.1, 2}, field_of_view);
  v.field({"baseline", "m", "from the camera to the projector; more throws longer shadows", 0, 1}, baseline);
  v.field({"depth_noise", "m", "standard deviation at 0.8 m and frontal incidence; grows with the squared distance", 0,
           0.01},
          depth_noise);
  v.field({"max_incidence", "rad", "surfaces that are seen flatter than this are not measured", 0.1, 1.5533},
          max_incidence);
  v.field({"seed", "", "of the noise", 0, 2147483647}, seed);
}
}  // namespace bin_picking::simulation
