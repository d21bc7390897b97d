// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "random.hpp"

#include <cmath>

namespace bin_picking::simulation
{
namespace
{
constexpr double RANGE = 4294967296.0;  // numbers of the engine
}

double Random::uniform(double low, double high)
{
  return low + (high - low) * (static_cast<double>(engine_()) / RANGE);
}

int Random::below(int count) { return static_cast<int>(uniform(0, count)); }

double Random::normal()
{
  std::uint64_t sum = 0;
  for (int i = 0; i < 12; ++i)
    sum += engine_();
  return static_cast<double>(sum) / RANGE - 6;
}

Eigen::Quaterniond Random::rotation()
{
  // Even in the ball of four dimensions, then on its surface: no sine or cosine, whose last bits differ between
  // libraries.
  while (true)
  {
    Eigen::Vector4d q;
    for (int i = 0; i < 4; ++i)
      q[i] = uniform(-1, 1);
    const double norm = q.squaredNorm();
    if (norm <= 1 && norm > 1e-6)
      return Eigen::Quaterniond(q / std::sqrt(norm));
  }
}

Eigen::Vector3d Random::inBall()
{
  while (true)
  {
    Eigen::Vector3d p;
    for (int i = 0; i < 3; ++i)
      p[i] = uniform(-1, 1);
    if (p.squaredNorm() <= 1)
      return p;
  }
}
}  // namespace bin_picking::simulation
