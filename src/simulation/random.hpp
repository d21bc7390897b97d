// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <random>

namespace bin_picking::simulation
{
/// Random numbers that are the same bits with every standard library (the library's distributions are not).
class Random
{
public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}

  /// [low, high)
  double uniform(double low, double high);
  /// Whole number in [0, count).
  int below(int count);
  /// Mean 0, standard deviation 1: the sum of twelve even numbers, so never beyond 6.
  double normal();
  /// Even over all rotations.
  Eigen::Quaterniond rotation();
  /// Even in the unit ball.
  Eigen::Vector3d inBall();

private:
  std::mt19937 engine_;
};
}  // namespace bin_picking::simulation
