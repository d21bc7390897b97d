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
/// Noise grows with the slope to here; what is steeper is mostly lost.
constexpr double MIN_COSINE = 0.1;
/// The bias is the sensor's own, the same in every exposure.
constexpr std::uint32_t BIAS_SEED = 20220817;

/// Noise pictures of standard deviation 1.
struct NoiseFields
{
  std::vector<float> correlated;
  std::vector<float> bias;
};

NoiseFields drawFields(const EffectContext& context)
{
  const SensorParameters& p = context.parameters;
  NoiseFields fields;
  if (p.noise.depth_noise > 0 && p.noise.white_share < 1)
    fields.correlated = correlatedNoise(p.width, p.height, p.noise.correlation_length,
                                        PixelRandom(context.seed, static_cast<std::uint32_t>(RandomStream::Correlated)),
                                        context.executor);
  if (p.noise.bias > 0)
    fields.bias = smoothNoise(p.width, p.height, p.noise.bias_length,
                              PixelRandom(BIAS_SEED, static_cast<std::uint32_t>(RandomStream::Bias)), context.executor);
  return fields;
}

class Digitizer
{
public:
  Digitizer(const EffectContext& context)
      : view_(context.view),
        parameters_(context.parameters),
        fields_(drawFields(context)),
        white_(context.seed, static_cast<std::uint32_t>(RandomStream::White)),
        white_weight_(std::sqrt(parameters_.noise.white_share)),
        correlated_weight_(std::sqrt(1 - parameters_.noise.white_share))
  {}

  double measured(double depth, int u, int v) const { return rounded(depth + error(depth, u, v)); }

private:
  double error(double depth, int u, int v) const
  {
    const std::size_t i = view_.index(u, v);
    const double growth = depth * depth / (parameters_.reference_distance * parameters_.reference_distance);
    double noise = 0;
    if (parameters_.noise.depth_noise > 0)
    {
      if (!fields_.correlated.empty())
        noise += correlated_weight_ * static_cast<double>(fields_.correlated[i]);
      if (parameters_.noise.white_share > 0)
        noise += white_weight_ * white_.normal(u, v);
      noise *= parameters_.noise.depth_noise / incidenceCosine(u, v);
    }
    const double bias = fields_.bias.empty() ? 0 : parameters_.noise.bias * static_cast<double>(fields_.bias[i]);
    return growth * (noise + bias);
  }

  double incidenceCosine(int u, int v) const
  {
    if (view_.labels[view_.index(u, v)] < 0)
      return 1;  // a window found a surface beside nothing
    const double cosine = -view_.normals[view_.index(u, v)].cast<double>().dot(view_.ray(u, v).normalized());
    return std::max(cosine, MIN_COSINE);
  }

  double rounded(double depth) const
  {
    const double disparity_of_one_metre = view_.camera.fx * parameters_.baseline;
    const double disparity_step = parameters_.noise.disparity_step;
    if (disparity_step > 0 && disparity_of_one_metre > 0)
    {
      const double steps = std::max(1.0, std::round(disparity_of_one_metre / depth / disparity_step));
      depth = disparity_of_one_metre / (steps * disparity_step);
    }
    if (parameters_.noise.depth_step > 0)
      depth = std::round(depth / parameters_.noise.depth_step) * parameters_.noise.depth_step;
    return depth;
  }

  const SensorView& view_;
  const SensorParameters& parameters_;
  NoiseFields fields_;
  PixelRandom white_;
  double white_weight_;
  double correlated_weight_;
};
}  // namespace

DepthGrid digitize(const Exposure& exposure, const EffectContext& context)
{
  const SensorView& view = context.view;
  const Digitizer digitizer(context);
  DepthGrid grid = makeGrid(view.width, view.height, view.camera);
  context.executor.forEach(static_cast<std::size_t>(view.height), [&](std::size_t row) {
    const int v = static_cast<int>(row);
    for (int u = 0; u < view.width; ++u)
    {
      const std::size_t i = view.index(u, v);
      if (exposure.received[i] == 0)
        continue;
      const double depth = digitizer.measured(static_cast<double>(exposure.depth[i]), u, v);
      if (!(depth > 0))
        continue;
      const Eigen::Vector3d point = view.camera.backProject(u, v, depth);
      grid.x[i] = static_cast<float>(point.x());
      grid.y[i] = static_cast<float>(point.y());
      grid.z[i] = static_cast<float>(point.z());
    }
  });
  return grid;
}
}  // namespace bin_picking::simulation
