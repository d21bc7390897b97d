// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "axis_text.hpp"

#include <cmath>

#include "bin_picking_perception/common/figures.hpp"

namespace bin_picking
{
namespace
{
std::string vectorText(const Eigen::Vector3d& v, double scale, int digits)
{
  std::string text;
  for (int k = 0; k < 3; ++k)
  {
    const double unit = std::pow(10, -digits);
    const double value = std::abs(v[k] * scale) < unit / 2 ? 0 : v[k] * scale;  // no "-0.00"
    text += (k == 0 ? "(" : ", ") + roundedText(value, digits);
  }
  return text + ")";
}
}  // namespace

std::string axisText(const Symmetry::Axis& axis)
{
  int largest = 0;
  axis.direction.cwiseAbs().maxCoeff(&largest);
  const Eigen::Vector3d direction = axis.direction[largest] < 0 ? Eigen::Vector3d(-axis.direction) : axis.direction;
  const Eigen::Vector3d foot = axis.origin - axis.origin.dot(direction) * direction;
  const bool along_drawing = direction[largest] > 1 - 1e-8;
  return (along_drawing ? std::string(1, static_cast<char>('x' + largest)) : vectorText(direction, 1, 4)) +
         " through " + vectorText(foot, 1000, 2) + " mm";
}
}  // namespace bin_picking
