// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <cmath>

#include "../common/parameter_text.hpp"
#include "bin_picking_perception/model/symmetry_search.hpp"

namespace bin_picking
{
namespace
{
std::string millimetres(double metres) { return roundedText(1000 * metres, 2) + " mm"; }

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

std::string kindText(int order)
{
  return order == AxisFinding::CONTINUOUS ? "continuous" : "order " + std::to_string(order);
}
}  // namespace

std::vector<std::string> describe(const SymmetryReport& report)
{
  std::vector<std::string> sentences;
  if (report.found.empty())
    sentences.push_back("no turn keeps the surface within " + millimetres(report.tolerance));
  for (const AxisFinding& one : report.found)
    sentences.push_back(kindText(one.order) + " about " + axisText(one.axis) + ": largest deviation " +
                        millimetres(one.mismatch.deviation) + ", up to " + millimetres(report.tolerance) +
                        " is allowed");
  if (report.round)
    sentences.push_back("round about more than one axis: only the position of this part has a meaning");
  for (const AxisFinding& one : report.almost)
    sentences.push_back("almost " + kindText(one.order) + " about " + axisText(one.axis) + ": " +
                        roundedText(100 * one.mismatch.share, 1) + " % of the surface breaks it, up to " +
                        millimetres(one.mismatch.deviation) + " high and " +
                        roundedText(1000 * one.mismatch.region, 0) + " mm across");
  return sentences;
}
}  // namespace bin_picking
