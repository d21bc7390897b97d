// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <limits>

#include "sensor_effects.hpp"

namespace bin_picking::simulation
{
namespace
{
struct Sample
{
  float depth = 0;
  bool received = false;
};

/// The pixels of one window, and whether an edge or the border of all surfaces runs through it.
struct Window
{
  std::vector<Sample> samples;
  int num_pixels = 0;  ///< with those that see nothing
  bool has_edge = false;
};

void gather(const Exposure& exposure, const std::vector<float>& edges, const SensorView& view, int u, int v, int half,
            Window& window)
{
  window = {std::move(window.samples), 0, false};
  window.samples.clear();
  for (int b = std::max(0, v - half); b <= std::min(view.height - 1, v + half); ++b)
    for (int a = std::max(0, u - half); a <= std::min(view.width - 1, u + half); ++a)
    {
      const std::size_t i = view.index(a, b);
      ++window.num_pixels;
      if (view.labels[i] < 0 || !std::isnan(edges[i]))
        window.has_edge = true;
      if (view.labels[i] >= 0)
        window.samples.push_back({exposure.depth[i], exposure.received[i] != 0});
    }
}

/// Index of the first sample, sorted by depth, beyond the widest gap; the number of samples if none is a jump.
std::size_t splitByDepth(std::vector<Sample>& samples, double jump)
{
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
    return a.depth != b.depth ? a.depth < b.depth : a.received < b.received;
  });
  std::size_t split = samples.size();
  auto widest = static_cast<float>(jump);
  for (std::size_t i = 1; i < samples.size(); ++i)
    if (samples[i].depth - samples[i - 1].depth > widest)
    {
      widest = samples[i].depth - samples[i - 1].depth;
      split = i;
    }
  return split;
}

/// Disparity is what is averaged: a plane's is linear in the pixel, so that flat surfaces stay exactly flat.
Sample meanOf(const std::vector<Sample>& samples, std::size_t begin, std::size_t end)
{
  double inverse_depth = 0;
  std::size_t num_received = 0;
  for (std::size_t i = begin; i < end; ++i)
  {
    inverse_depth += 1 / static_cast<double>(samples[i].depth);
    num_received += samples[i].received ? 1 : 0;
  }
  if (begin == end)
    return {std::numeric_limits<float>::quiet_NaN(), false};
  return {static_cast<float>(static_cast<double>(end - begin) / inverse_depth), 2 * num_received > end - begin};
}

/// The nearer surface wins by filling enough of the window; around that the result passes from one to the other.
Sample winner(Window& window, const SensorEdges& parameters)
{
  std::vector<Sample>& samples = window.samples;
  if (!window.has_edge)
    return meanOf(samples, 0, samples.size());
  const std::size_t split = splitByDepth(samples, parameters.jump);
  const Sample nearer = meanOf(samples, 0, split);
  const Sample farther = meanOf(samples, split, samples.size());
  const double lead = static_cast<double>(split) / window.num_pixels - parameters.fattening;
  const Sample& best = lead >= 0 ? nearer : farther;
  if (std::abs(lead) >= 0.5 * parameters.mixed_pixels || std::isnan(nearer.depth) || std::isnan(farther.depth))
    return best;
  const double t = lead / parameters.mixed_pixels + 0.5;
  const double inverse_depth = t / static_cast<double>(nearer.depth) + (1 - t) / static_cast<double>(farther.depth);
  return {static_cast<float>(1 / inverse_depth), best.received};
}
}  // namespace

void matchWindows(Exposure& exposure, const std::vector<float>& edges, const EffectContext& context)
{
  const SensorView& view = context.view;
  const int half = context.parameters.edges.window / 2;
  const Exposure before = exposure;
  context.executor.forEach(static_cast<std::size_t>(view.height), [&](std::size_t row) {
    Window window;
    const int v = static_cast<int>(row);
    for (int u = 0; u < view.width; ++u)
    {
      gather(before, edges, view, u, v, half, window);
      const Sample best = winner(window, context.parameters.edges);
      exposure.depth[view.index(u, v)] = best.depth;
      exposure.received[view.index(u, v)] = best.received ? 1 : 0;
    }
  });
}
}  // namespace bin_picking::simulation
