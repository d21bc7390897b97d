// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "pixel_random.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace bin_picking::simulation
{
namespace
{
/// SplitMix64's finalizer (Steele, Lea, Flood 2014): every bit of the output depends on every bit of the input.
std::uint64_t mixed(std::uint64_t x)
{
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// A Gaussian's upper half, scaled so that blurring white noise along one axis keeps its variance. Noise blurred with
/// standard deviation s is correlated as exp(-(d / 2s)^2).
std::vector<float> blurKernel(double length)
{
  const double sigma = 0.5 * length;
  std::vector<float> kernel(static_cast<std::size_t>(std::ceil(3 * sigma)) + 1);
  double energy = 0;
  for (std::size_t i = 0; i < kernel.size(); ++i)
  {
    const double distance = static_cast<double>(i) / sigma;
    kernel[i] = static_cast<float>(std::exp(-0.5 * distance * distance));
    energy += (i == 0 ? 1 : 2) * static_cast<double>(kernel[i]) * static_cast<double>(kernel[i]);
  }
  for (float& weight : kernel)
    weight = static_cast<float>(static_cast<double>(weight) / std::sqrt(energy));
  return kernel;
}

/// out[i] = sum of kernel[|k|] * in[i + reach + k].
void blurLine(const float* in, const std::vector<float>& kernel, float* out, std::size_t count)
{
  const std::size_t reach = kernel.size() - 1;
  for (std::size_t i = 0; i < count; ++i)
  {
    const float* centre = in + i + reach;
    float sum = kernel[0] * *centre;
    for (std::size_t k = 1; k <= reach; ++k)
      sum += kernel[k] * (*(centre - k) + *(centre + k));
    out[i] = sum;
  }
}
}  // namespace

PixelRandom::PixelRandom(std::uint32_t seed, std::uint32_t stream)
    : key_(mixed((static_cast<std::uint64_t>(seed) << 32 | stream) + 0x9e3779b97f4a7c15ull))
{}

std::uint64_t PixelRandom::hash(int u, int v, std::uint64_t draw) const
{
  constexpr int OFFSET = 1 << 15;
  const auto pixel = static_cast<std::uint64_t>(v + OFFSET) << 32 | static_cast<std::uint64_t>(u + OFFSET) << 8 | draw;
  return mixed(key_ + mixed(pixel * 0x9e3779b97f4a7c15ull));
}

double PixelRandom::normal(int u, int v) const
{
  std::uint64_t sum = 0;
  for (std::uint64_t draw = 1; draw <= 2; ++draw)
    for (std::uint64_t bits = hash(u, v, draw), lane = 0; lane < 4; ++lane, bits >>= 16)
      sum += bits & 0xffff;
  constexpr double SUM_OF_EIGHT_STANDARD_DEVIATION = 0.816496580927726;  // sqrt(8 / 12)
  return ((static_cast<double>(sum) + 4) / 65536.0 - 4) / SUM_OF_EIGHT_STANDARD_DEVIATION;
}

std::vector<float> correlatedNoise(int width, int height, double length, const PixelRandom& random,
                                   const Executor& executor)
{
  const std::vector<float> kernel = blurKernel(length);
  const int reach = static_cast<int>(kernel.size()) - 1;
  const auto columns = static_cast<std::size_t>(width);
  const std::size_t rows = static_cast<std::size_t>(height) + 2 * (kernel.size() - 1);
  std::vector<float> across(columns * rows);
  executor.forEach(rows, [&](std::size_t row) {
    std::vector<float> white(columns + 2 * (kernel.size() - 1));
    for (std::size_t i = 0; i < white.size(); ++i)
      white[i] = static_cast<float>(random.normal(static_cast<int>(i) - reach, static_cast<int>(row) - reach));
    blurLine(white.data(), kernel, across.data() + row * columns, columns);
  });
  std::vector<float> out(columns * static_cast<std::size_t>(height));
  executor.forEach(static_cast<std::size_t>(height), [&](std::size_t row) {
    float* line = out.data() + row * columns;
    for (std::size_t k = 0; k < 2 * kernel.size() - 1; ++k)
    {
      const float weight = kernel[k < kernel.size() ? kernel.size() - 1 - k : k + 1 - kernel.size()];
      const float* source = across.data() + (row + k) * columns;
      for (std::size_t i = 0; i < columns; ++i)
        line[i] += weight * source[i];
    }
  });
  return out;
}

std::vector<float> smoothNoise(int width, int height, double length, const PixelRandom& random,
                               const Executor& executor)
{
  constexpr double CELLS_PER_LENGTH = 4;  // so fine that lines between the points lose only 2 % of the variance
  const double step = std::max(1.0, length / CELLS_PER_LENGTH);
  const auto cells = [&](int pixels) { return static_cast<int>(std::ceil(pixels / step)) + 2; };
  const int columns = cells(width);
  const std::vector<float> coarse = correlatedNoise(columns, cells(height), length / step, random, executor);
  std::vector<float> out(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  executor.forEach(static_cast<std::size_t>(height), [&](std::size_t row) {
    const auto v = static_cast<std::size_t>(static_cast<double>(row) / step);
    const auto b = static_cast<float>(static_cast<double>(row) / step - static_cast<double>(v));
    for (std::size_t column = 0; column < static_cast<std::size_t>(width); ++column)
    {
      const auto u = static_cast<std::size_t>(static_cast<double>(column) / step);
      const auto a = static_cast<float>(static_cast<double>(column) / step - static_cast<double>(u));
      const float* upper = coarse.data() + v * static_cast<std::size_t>(columns) + u;
      const float* lower = upper + columns;
      out[row * static_cast<std::size_t>(width) + column] =
          (1 - b) * ((1 - a) * upper[0] + a * upper[1]) + b * ((1 - a) * lower[0] + a * lower[1]);
    }
  });
  return out;
}
}  // namespace bin_picking::simulation
