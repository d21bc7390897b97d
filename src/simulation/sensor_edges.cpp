// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pixel_random.hpp"
#include "sensor_effects.hpp"

namespace bin_picking::simulation
{
namespace
{
PixelRandom stream(const EffectContext& context, RandomStream use)
{
  return PixelRandom(context.seed, static_cast<std::uint32_t>(use));
}

/// How far the depth of pixel b lies off the plane of pixel a's surface.
double offPlane(const SensorView& view, std::size_t a, const Eigen::Vector3d& point_a, std::size_t b,
                const Eigen::Vector3d& ray_b)
{
  const Eigen::Vector3d normal = view.normals[a].cast<double>();
  return std::abs(normal.dot(point_a) / normal.dot(ray_b) - static_cast<double>(view.depth[b]));
}

/// Depth of the neighbour farthest off across a jump; NaN: none. A slope is no jump, nor is a crease: one of the two
/// surfaces, continued, meets the other.
float acrossEdge(const SensorView& view, int u, int v, double jump)
{
  constexpr std::array<std::array<int, 2>, 4> NEIGHBOURS = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  const std::size_t a = view.index(u, v);
  const Eigen::Vector3d point = view.point(u, v);
  float across = std::numeric_limits<float>::quiet_NaN();
  float farthest = static_cast<float>(jump);
  for (const auto& [du, dv] : NEIGHBOURS)
  {
    if (!view.inside(u + du, v + dv) || view.labels[view.index(u + du, v + dv)] < 0)
      continue;
    const std::size_t b = view.index(u + du, v + dv);
    const float difference = std::abs(view.depth[b] - view.depth[a]);
    if (difference <= farthest || offPlane(view, a, point, b, view.ray(u + du, v + dv)) <= jump ||
        offPlane(view, b, view.point(u + du, v + dv), a, view.ray(u, v)) <= jump)
      continue;
    farthest = difference;
    across = view.depth[b];
  }
  return across;
}

struct Offset
{
  int du = 0;
  int dv = 0;
};

/// The pixels whose centres lie in a disc.
std::vector<Offset> disc(double radius)
{
  std::vector<Offset> offsets;
  const int reach = static_cast<int>(radius);
  for (int dv = -reach; dv <= reach; ++dv)
    for (int du = -reach; du <= reach; ++du)
      if (du * du + dv * dv <= radius * radius)
        offsets.push_back({du, dv});
  return offsets;
}
/// Even numbers in [0, 1], alike within a patch.
std::vector<float> lossDraws(const EffectContext& context)
{
  const SensorView& view = context.view;
  const double patch = context.parameters.edges.loss_size;
  const PixelRandom random = stream(context, RandomStream::EdgeLoss);
  std::vector<float> draws(view.size());
  if (patch > 1)
    draws = correlatedNoise(view.width, view.height, 0.5 * patch, random, context.executor);
  context.executor.forEach(static_cast<std::size_t>(view.height), [&](std::size_t row) {
    for (int u = 0, v = static_cast<int>(row); u < view.width; ++u)
    {
      float& draw = draws[view.index(u, v)];
      draw = static_cast<float>(patch > 1 ? 0.5 * std::erfc(-static_cast<double>(draw) * M_SQRT1_2)
                                          : random.uniform(u, v));
    }
  });
  return draws;
}
}  // namespace

std::vector<float> findEdges(const EffectContext& context)
{
  const SensorView& view = context.view;
  std::vector<float> edges(view.size(), std::numeric_limits<float>::quiet_NaN());
  context.executor.forEach(static_cast<std::size_t>(view.height), [&](std::size_t row) {
    const int v = static_cast<int>(row);
    for (int u = 0; u < view.width; ++u)
      if (view.labels[view.index(u, v)] >= 0)
        edges[view.index(u, v)] = acrossEdge(view, u, v, context.parameters.edges.jump);
  });
  return edges;
}

void losePixelsBesideEdges(Exposure& exposure, const std::vector<float>& edges, const EffectContext& context)
{
  const SensorView& view = context.view;
  const SensorEdges& parameters = context.parameters.edges;
  if (parameters.loss_width == 0 || parameters.loss == 0)
    return;
  const std::vector<float> draws = lossDraws(context);
  // The pixels next to the edge are half a pixel away from it.
  const std::vector<Offset> beside = disc(std::max(0.0, parameters.loss_width - 0.5));
  for (int v = 0; v < view.height; ++v)
    for (int u = 0; u < view.width; ++u)
    {
      if (std::isnan(edges[view.index(u, v)]))
        continue;
      for (const Offset& offset : beside)
        if (view.inside(u + offset.du, v + offset.dv) &&
            static_cast<double>(draws[view.index(u + offset.du, v + offset.dv)]) < parameters.loss)
          exposure.received[view.index(u + offset.du, v + offset.dv)] = 0;
    }
}

void mixAcrossEdges(Exposure& exposure, const std::vector<float>& edges, const EffectContext& context)
{
  const SensorView& view = context.view;
  const PixelRandom mixed = stream(context, RandomStream::MixedPixels);
  const PixelRandom share = stream(context, RandomStream::MixedDepth);
  for (int v = 0; v < view.height; ++v)
    for (int u = 0; u < view.width; ++u)
    {
      const std::size_t i = view.index(u, v);
      if (std::isnan(edges[i]) || mixed.uniform(u, v) >= context.parameters.edges.mixed_pixels)
        continue;
      const auto t = static_cast<float>(share.uniform(u, v));
      exposure.depth[i] = (1 - t) * view.depth[i] + t * edges[i];
      exposure.received[i] = 1;
    }
}

void punchHoles(Exposure& exposure, const EffectContext& context)
{
  const SensorView& view = context.view;
  const SensorNoise& parameters = context.parameters.noise;
  if (parameters.drop_outs == 0)
    return;
  const std::vector<Offset> hole = disc(0.5 * parameters.drop_out_size);
  const int reach = static_cast<int>(0.5 * parameters.drop_out_size);
  // Holes overlap: with so many per pixel, the wanted share is covered by at least one.
  const double holes_per_pixel = -std::log1p(-parameters.drop_outs) / static_cast<double>(hole.size());
  const PixelRandom random = stream(context, RandomStream::DropOuts);
  for (int v = -reach; v < view.height + reach; ++v)
    for (int u = -reach; u < view.width + reach; ++u)
    {
      if (random.uniform(u, v) >= holes_per_pixel)
        continue;
      for (const Offset& offset : hole)
        if (view.inside(u + offset.du, v + offset.dv))
          exposure.received[view.index(u + offset.du, v + offset.dv)] = 0;
    }
}
}  // namespace bin_picking::simulation
