// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <random>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking
{
namespace
{
constexpr double MAX_SAMPLES = 20e6;

using Corners = std::array<Eigen::Vector3d, 3>;

Corners cornersOf(const TriangleMesh& mesh, std::size_t triangle)
{
  const auto& t = mesh.triangles[triangle];
  return {mesh.vertices[t[0]].cast<double>(), mesh.vertices[t[1]].cast<double>(), mesh.vertices[t[2]].cast<double>()};
}

Eigen::Vector3d areaVector(const Corners& c) { return (c[1] - c[0]).cross(c[2] - c[0]) / 2; }

/// The point of a triangle at `fraction` of its area along a space-filling curve: the triangle is halved again and
/// again at the middle of its longest edge, and the fraction says into which half to go. Equal steps of the fraction
/// are equal areas of compact shape, so an evenly spaced fraction gives evenly spread points.
Eigen::Vector3d pointAtFraction(Corners c, double fraction)
{
  // 40 halvings shrink the triangle to a millionth of its length and use up the digits of the fraction.
  for (int i = 0; i < 40; ++i)
  {
    const std::array<double, 3> opposite = {(c[2] - c[1]).squaredNorm(), (c[0] - c[2]).squaredNorm(),
                                            (c[1] - c[0]).squaredNorm()};
    const auto apex = static_cast<std::size_t>(std::max_element(opposite.begin(), opposite.end()) - opposite.begin());
    const Eigen::Vector3d middle = (c[(apex + 1) % 3] + c[(apex + 2) % 3]) / 2;
    fraction *= 2;
    const bool second = fraction >= 1;
    if (second)
      fraction -= 1;
    c = second ? Corners{c[apex], middle, c[(apex + 2) % 3]} : Corners{c[apex], c[(apex + 1) % 3], middle};
  }
  return (c[0] + c[1] + c[2]) / 3;
}

std::vector<double> cumulatedArea(const TriangleMesh& mesh)
{
  std::vector<double> sum;
  sum.reserve(mesh.triangles.size());
  double area = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    sum.push_back(area += areaVector(cornersOf(mesh, i)).norm());
  return sum;
}

std::size_t numSamples(double area, double spacing)
{
  if (!(spacing > 0))
    throw ParameterError("the spacing of surface samples is " + std::to_string(spacing) +
                         " m, but it must be positive; a tenth of the leaf is a good value");
  const double count = area / (spacing * spacing);
  if (!(count <= MAX_SAMPLES))
    throw ParameterError("a spacing of " + std::to_string(spacing * 1e3) +
                         " mm would draw more than 20 million surface samples; use a coarser one");
  return static_cast<std::size_t>(std::max(1.0, std::round(count)));
}
}  // namespace

OrientedPoints sampleSurface(const TriangleMesh& mesh, double spacing, std::uint32_t seed)
{
  const std::vector<double> sum = cumulatedArea(mesh);
  if (sum.empty() || !(sum.back() > 0))
    throw ParameterError("a mesh without area cannot be sampled; load a mesh that has triangles");
  const std::size_t count = numSamples(sum.back(), spacing);
  OrientedPoints samples;
  samples.points.reserve(count);
  samples.normals.reserve(count);
  const double end = std::nextafter(sum.back(), 0.0);
  std::mt19937 random(seed);
  std::size_t triangle = 0;
  // One draw per equal share of the area. The walk through the triangles goes forward only.
  for (std::size_t i = 0; i < count; ++i)
  {
    const double jitter = random() / 4294967296.0;
    const double at = std::min((static_cast<double>(i) + jitter) / static_cast<double>(count) * sum.back(), end);
    while (sum[triangle] <= at)
      ++triangle;
    const double begin = triangle == 0 ? 0 : sum[triangle - 1];
    const double fraction = std::clamp((at - begin) / (sum[triangle] - begin), 0.0, 1 - 1e-12);
    const Corners corners = cornersOf(mesh, triangle);
    samples.points.push_back(pointAtFraction(corners, fraction).cast<float>());
    samples.normals.push_back(areaVector(corners).normalized().cast<float>());
  }
  return samples;
}
}  // namespace bin_picking
