// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "sensor_view.hpp"

namespace bin_picking::simulation
{
/// A picture on its way from what is there to what is measured.
struct Exposure
{
  std::vector<float> depth;            ///< metres; NaN: no surface
  std::vector<std::uint8_t> received;  ///< 1 where both eyes get enough light and not too much
};

/// What an effect needs to know; the referenced things must outlive it.
struct EffectContext
{
  const SensorView& view;
  const SensorParameters& parameters;
  const Executor& executor;
  std::uint32_t seed;
};

/// The streams of random numbers, one per use.
enum class RandomStream : std::uint32_t
{
  Signal,
  Highlight,
  Incidence,
  EdgeLoss,
  MixedPixels,
  MixedDepth,
  DropOuts,
  White,
  Correlated,
  Bias
};

/// What light comes back: shadow and field of the second eye, incidence, brightness, highlights.
Exposure expose(const RayScene& scene, const EffectContext& context);

/// Per pixel the depth of the farthest-off neighbour across a jump of depth; NaN: no edge here.
std::vector<float> findEdges(const EffectContext& context);

/// Depths as found by comparing windows: the mean disparity of the surface that wins the window.
void matchWindows(Exposure& exposure, const std::vector<float>& edges, const EffectContext& context);

void losePixelsBesideEdges(Exposure& exposure, const std::vector<float>& edges, const EffectContext& context);

/// Flying pixels: some at an edge report a depth somewhere between the two surfaces.
void mixAcrossEdges(Exposure& exposure, const std::vector<float>& edges, const EffectContext& context);

/// Loses round patches without cause.
void punchHoles(Exposure& exposure, const EffectContext& context);

/// Adds noise, rounds to steps, and turns depths into points.
DepthGrid digitize(const Exposure& exposure, const EffectContext& context);
}  // namespace bin_picking::simulation
